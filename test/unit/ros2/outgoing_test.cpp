#include <cstring>

#include <idl/ros2/diagnostic_msgs.h>
#include <idl/ros2/nav_msgs.h>
#include <idl/ros2/tf2_msgs.h>

#include "shared/ros2/diagnostics_codec.hpp"
#include "shared/ros2/point_cloud_codec.hpp"
#include "shared/ros2/pose_covariance.hpp"
#include "test/unit/ros2/samples.hpp"

// What is only sent, read by the generated types.
namespace fleetloc {
namespace {

void expect_some_header(const std_msgs::msg::dds_::Header_& header) {
  EXPECT_EQ(header.stamp().sec(), 1'403'636'579);
  EXPECT_EQ(header.stamp().nanosec(), 763'555'584U);
  EXPECT_EQ(header.frame_id(), "map");
}

template <typename Quaternion>
void expect_some_rotation(const Quaternion& q) {
  EXPECT_EQ(Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).coeffs(), some_pose().R.coeffs());
}

template <typename Vector>
Eigen::Vector3d vector(const Vector& v) {
  return {v.x(), v.y(), v.z()};
}

TEST(Ros2Outgoing, OdometryHasThePoseInItsFrameAndTheTwistInTheChilds) {
  OdometryMessage sent{.pose = some_pose_message(), .child_frame = "base_link"};
  sent.v_b = {1.0, 2.0, 3.0};
  sent.angular_velocity = {4.0, 5.0, 6.0};
  sent.twist_covariance = 2.0 * some_covariance();
  const auto odometry = from_ros2_cdr<nav_msgs::msg::dds_::Odometry_>(encode(sent)).value();
  expect_some_header(odometry.header());
  EXPECT_EQ(odometry.child_frame_id(), "base_link");
  EXPECT_EQ(vector(odometry.pose().pose().position()), some_pose().p);
  expect_some_rotation(odometry.pose().pose().orientation());
  EXPECT_EQ(odometry.pose().covariance(), to_ros2_covariance(some_covariance(), some_pose().R));
  EXPECT_EQ(vector(odometry.twist().twist().linear()), sent.v_b);
  EXPECT_EQ(vector(odometry.twist().twist().angular()), sent.angular_velocity);
  EXPECT_EQ(odometry.twist().covariance(), to_ros2_twist_covariance(sent.twist_covariance));
}

TEST(Ros2Outgoing, TransformsKeepTheirOrder) {
  const std::vector<TransformMessage> sent{
      {.header = some_header(), .child_frame = "odom", .T_a_b = some_pose()},
      {.header = some_header(), .child_frame = "base_link", .T_a_b = {}}};
  const auto message = from_ros2_cdr<tf2_msgs::msg::dds_::TFMessage_>(encode(sent)).value();
  ASSERT_EQ(message.transforms().size(), 2U);
  const auto& first = message.transforms()[0];
  expect_some_header(first.header());
  EXPECT_EQ(first.child_frame_id(), "odom");
  EXPECT_EQ(vector(first.transform().translation()), some_pose().p);
  expect_some_rotation(first.transform().rotation());
  EXPECT_EQ(message.transforms()[1].child_frame_id(), "base_link");
  EXPECT_EQ(message.transforms()[1].transform().rotation().w(), 1.0);
}

TEST(Ros2Outgoing, DiagnosticsHaveEveryFieldOfEveryStatus) {
  const DiagnosticsMessage sent{.header = some_header(),
                                .statuses = {{.level = DiagnosticStatus::Level::kStale,
                                              .component = "camera",
                                              .message = "no images",
                                              .hardware = "left",
                                              .values = {{"age_s", "2.5"}, {"rate", ""}}},
                                             {}}};
  const auto array =
      from_ros2_cdr<diagnostic_msgs::msg::dds_::DiagnosticArray_>(encode(sent)).value();
  expect_some_header(array.header());
  ASSERT_EQ(array.status().size(), 2U);
  const auto& status = array.status()[0];
  EXPECT_EQ(status.level(), 3);
  EXPECT_EQ(status.name(), "camera");
  EXPECT_EQ(status.message(), "no images");
  EXPECT_EQ(status.hardware_id(), "left");
  ASSERT_EQ(status.values().size(), 2U);
  EXPECT_EQ(status.values()[0].key(), "age_s");
  EXPECT_EQ(status.values()[0].value(), "2.5");
  EXPECT_EQ(status.values()[1].key(), "rate");
  EXPECT_EQ(array.status()[1].level(), 0);
}

TEST(Ros2Outgoing, PointCloudsDescribeTheirBytes) {
  const PointCloudMessage sent{.header = some_header(),
                               .points = {{1.0F, 2.0F, 3.0F}, {-4.0F, 5.5F, 6.0F}}};
  const auto cloud = from_ros2_cdr<sensor_msgs::msg::dds_::PointCloud2_>(encode(sent)).value();
  expect_some_header(cloud.header());
  EXPECT_EQ(cloud.height(), 1U);
  EXPECT_EQ(cloud.width(), 2U);
  EXPECT_EQ(cloud.point_step(), 12U);
  EXPECT_EQ(cloud.row_step(), 24U);
  EXPECT_FALSE(cloud.is_bigendian());
  EXPECT_TRUE(cloud.is_dense());
  ASSERT_EQ(cloud.fields().size(), 3U);
  ASSERT_EQ(cloud.data().size(), 24U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& field = cloud.fields()[i];
    EXPECT_EQ(field.name(), std::string(1, "xyz"[i]));
    EXPECT_EQ(field.datatype(), 7);
    EXPECT_EQ(field.count(), 1U);
    float second = 0.0F;
    std::memcpy(&second, cloud.data().data() + cloud.point_step() + field.offset(), sizeof second);
    EXPECT_EQ(second, sent.points[1][static_cast<Eigen::Index>(i)]);
  }
}

TEST(Ros2Outgoing, ACloudWithoutPointsIsACloud) {
  const auto bytes = encode(PointCloudMessage{.header = some_header(), .points = {}});
  const auto cloud = from_ros2_cdr<sensor_msgs::msg::dds_::PointCloud2_>(bytes).value();
  EXPECT_EQ(cloud.width(), 0U);
  EXPECT_TRUE(cloud.data().empty());
}

}  // namespace
}  // namespace fleetloc
