#include "deploy/sim/recording/dataset_writer.hpp"

#include <iomanip>
#include <limits>
#include <string>
#include <system_error>

#include "robot/dataset/image_file.hpp"
#include "shared/dataset/sensor_file.hpp"

namespace fleetloc {
namespace {

void create(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw DatasetError(folder.string() + ": " + error.message());
}

std::ofstream open(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << std::setprecision(std::numeric_limits<double>::max_digits10) << text;
  if (!stream) throw DatasetError(file.string() + ": cannot be written");
  return stream;
}

void write(std::ostream& csv, const Eigen::Vector3d& v) {
  csv << ',' << v.x() << ',' << v.y() << ',' << v.z();
}

std::filesystem::path mav0_of(const DatasetWriter::Options& options) {
  return options.folder / "mav0";
}

std::ofstream create_camera(const DatasetWriter::Options& options,
                            const char* name,
                            const Camera& camera,
                            const Pose& T_body_cam) {
  const auto folder = mav0_of(options) / name;
  create(folder / "data");
  open(folder / "sensor.yaml",
       camera_file_text(
           {.camera = camera, .T_rig_cam = T_body_cam, .rate_hz = options.frame_rate_hz}));
  return open(folder / "data.csv", "#timestamp [ns],filename\n");
}

std::ofstream create_imu(const DatasetWriter::Options& options) {
  const auto folder = mav0_of(options) / "imu0";
  create(folder);
  open(
      folder / "sensor.yaml",
      imu_file_text({.noise = options.imu_noise, .T_rig_imu = {}, .rate_hz = options.imu_rate_hz}));
  return open(folder / "data.csv",
              "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
              "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n");
}

std::ofstream create_ground_truth(const DatasetWriter::Options& options) {
  const auto folder = mav0_of(options) / "state_groundtruth_estimate0";
  create(folder);
  return open(folder / "data.csv",
              "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],"
              "q_RS_y [],q_RS_z [],v_RS_R_x [m s^-1],v_RS_R_y [m s^-1],v_RS_R_z [m s^-1],"
              "b_w_RS_S_x [rad s^-1],b_w_RS_S_y [rad s^-1],b_w_RS_S_z [rad s^-1],"
              "b_a_RS_S_x [m s^-2],b_a_RS_S_y [m s^-2],b_a_RS_S_z [m s^-2]\n");
}

}  // namespace

DatasetWriter::DatasetWriter(const Options& options)
    : options_(options),
      cam0_csv_(create_camera(
          options, "cam0", options.calibration.cam0, options.calibration.T_body_cam0)),
      cam1_csv_(create_camera(
          options, "cam1", options.calibration.cam1, options.calibration.T_body_cam1)),
      imu_csv_(create_imu(options)) {}

void DatasetWriter::add(const ImuSample& sample) {
  imu_csv_ << sample.stamp.time_since_epoch().count();
  write(imu_csv_, sample.angular_velocity);
  write(imu_csv_, sample.specific_force);
  imu_csv_ << '\n';
}

void DatasetWriter::add(const StereoFrame& frame) {
  add_image(cam0_csv_, "cam0", frame.stamp, frame.left);
  add_image(cam1_csv_, "cam1", frame.stamp, frame.right);
}

void DatasetWriter::add_image(std::ofstream& csv,
                              const char* camera,
                              Timestamp stamp,
                              const cv::Mat& image) {
  if (image.empty()) return;
  const std::string text = std::to_string(stamp.time_since_epoch().count());
  const std::string name = text + (options_.format == ImageFormat::kPng ? ".png" : ".jpg");
  write_image(mav0_of(options_) / camera / "data" / name, image, options_.jpeg_quality);
  csv << text << ',' << name << '\n';
}

void DatasetWriter::add_ground_truth(Timestamp stamp, const NavState& state) {
  if (!ground_truth_csv_.is_open()) ground_truth_csv_ = create_ground_truth(options_);
  const Eigen::Quaterniond& R = state.T_odom_body.R;
  ground_truth_csv_ << stamp.time_since_epoch().count();
  write(ground_truth_csv_, state.T_odom_body.p);
  ground_truth_csv_ << ',' << R.w() << ',' << R.x() << ',' << R.y() << ',' << R.z();
  write(ground_truth_csv_, state.v_odom);
  write(ground_truth_csv_, state.bias.gyroscope);
  write(ground_truth_csv_, state.bias.accelerometer);
  ground_truth_csv_ << '\n';
}

void DatasetWriter::finish() {
  for (std::ofstream* csv : {&cam0_csv_, &cam1_csv_, &imu_csv_, &ground_truth_csv_}) {
    if (!csv->is_open()) continue;
    csv->close();
    if (!*csv) throw DatasetError(mav0_of(options_).string() + ": could not be written completely");
  }
}

}  // namespace fleetloc
