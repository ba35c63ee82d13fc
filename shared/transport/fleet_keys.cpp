#include "shared/transport/fleet_keys.hpp"

#include <array>
#include <fstream>
#include <memory>
#include <string_view>
#include <utility>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <sys/stat.h>

#include "shared/transport/transport_error.hpp"

namespace fleetloc {
namespace {

constexpr std::string_view kKey = "key.pem";
constexpr std::string_view kCertificate = "certificate.pem";
constexpr std::string_view kCa = "ca.pem";
constexpr std::string_view kPermissions = "permissions.smime";
constexpr std::string_view kGovernance = "governance.smime";
constexpr std::string_view kRevoked = "revoked.pem";
constexpr std::array kFiles{kKey, kCertificate, kCa, kPermissions, kGovernance, kRevoked};
constexpr std::array<std::pair<FleetRole, const char*>, 4> kRoles{
    {{FleetRole::kRobot, "robot"},
     {FleetRole::kLocalizer, "localizer"},
     {FleetRole::kMonitor, "monitor"},
     {FleetRole::kObserver, "observer"}}};

template <auto kFree>
struct FreeBy {
  template <typename Thing>
  void operator()(Thing* thing) const {
    kFree(thing);
  }
};
void close_file(std::FILE* file) {
  static_cast<void>(std::fclose(file));
}
using File = std::unique_ptr<std::FILE, FreeBy<close_file>>;
using Certificate = std::unique_ptr<X509, FreeBy<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, FreeBy<EVP_PKEY_free>>;
using RevocationList = std::unique_ptr<X509_CRL, FreeBy<X509_CRL_free>>;
using Subject = std::unique_ptr<X509_NAME, FreeBy<X509_NAME_free>>;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& reason) {
  throw TransportError(file.string() + ": " + reason);
}

void require_readable(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    refuse(file, "no such file; deploy/security/fleet-keys.sh makes it");
  }
  if (!std::ifstream(file)) refuse(file, "cannot be read");
}

void require_private(const std::filesystem::path& key) {
  struct stat status {};
  if (stat(key.c_str(), &status) != 0) refuse(key, "cannot be read");
  constexpr auto kOthers = S_IRWXG | S_IRWXO;
  if ((status.st_mode & kOthers) != 0) refuse(key, "others can read this key; chmod 600");
}

template <typename Owner>
Owner read_pem(const std::filesystem::path& file, const char* what, auto read) {
  const File opened(std::fopen(file.c_str(), "r"));
  if (!opened) refuse(file, "cannot be read");
  Owner owner(read(opened.get(), nullptr, nullptr, nullptr));
  if (!owner) refuse(file, std::string("is no ") + what);
  return owner;
}

void require_now(const std::filesystem::path& file, const ASN1_TIME* begin, const ASN1_TIME* end) {
  if (X509_cmp_current_time(end) < 0) refuse(file, "has ended; renew it with fleet-keys.sh");
  if (X509_cmp_current_time(begin) > 0) refuse(file, "is not yet good: is the clock right?");
}

std::string entry_of(const X509_NAME* subject, int id) {
  std::array<char, 128> text{};
  const int size =
      X509_NAME_get_text_by_NID(subject, id, text.data(), static_cast<int>(text.size()));
  return size < 0 ? "" : std::string(text.data(), static_cast<std::size_t>(size));
}

const char* role_name(FleetRole role) {
  for (const auto& [known, name] : kRoles) {
    if (known == role) return name;
  }
  return "";
}

void add_entry(X509_NAME* subject, const char* field, const std::string& text) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
  X509_NAME_add_entry_by_txt(
      subject, field, MBSTRING_UTF8, bytes, static_cast<int>(text.size()), -1, 0);
}

}  // namespace

FleetKeys::FleetKeys(std::filesystem::path folder)
    : folder_(std::filesystem::absolute(std::move(folder))) {
  for (const std::string_view file : kFiles) require_readable(folder_ / file);
  require_private(folder_ / kKey);
  const auto key = read_pem<Key>(folder_ / kKey, "private key", PEM_read_PrivateKey);
  const auto certificate =
      read_pem<Certificate>(folder_ / kCertificate, "certificate", PEM_read_X509);
  const auto ca = read_pem<Certificate>(folder_ / kCa, "certificate", PEM_read_X509);
  const auto revoked =
      read_pem<RevocationList>(folder_ / kRevoked, "revocation list", PEM_read_X509_CRL);
  for (const auto& [file, one] : {std::pair(kCertificate, certificate.get()), {kCa, ca.get()}}) {
    require_now(folder_ / file, X509_get0_notBefore(one), X509_get0_notAfter(one));
  }
  require_now(folder_ / kRevoked,
              X509_CRL_get0_lastUpdate(revoked.get()),
              X509_CRL_get0_nextUpdate(revoked.get()));
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    refuse(folder_ / kKey, "is not the key of certificate.pem");
  }
  if (X509_verify(certificate.get(), X509_get0_pubkey(ca.get())) != 1) {
    refuse(folder_ / kCertificate, "is not signed by ca.pem");
  }
  X509_REVOKED* entry = nullptr;
  if (X509_CRL_get0_by_cert(revoked.get(), &entry, certificate.get()) == 1) {
    refuse(folder_ / kCertificate, "is revoked");
  }
  const X509_NAME* subject = X509_get_subject_name(certificate.get());
  fleet_ = entry_of(subject, NID_organizationName);
  name_ = entry_of(subject, NID_commonName);
  const std::string role = entry_of(subject, NID_organizationalUnitName);
  for (const auto& [known, word] : kRoles) {
    if (role == word) {
      role_ = known;
      return;
    }
  }
  refuse(folder_ / kCertificate, "is of no robot, localizer, monitor or observer");
}

void FleetKeys::require(FleetRole role, const std::string& name) const {
  if (role == role_ && name == name_) return;
  refuse(folder_ / kCertificate,
         std::string("is of ") + role_name(role_) + " '" + name_ + "', not of " + role_name(role) +
             " '" + name + "'");
}

void FleetKeys::add_to(eprosima::fastrtps::rtps::PropertyPolicy& properties) const {
  const auto add = [&](const std::string& name, const std::string& value) {
    properties.properties().emplace_back("dds.sec." + name, value);
  };
  const auto add_file = [&](const std::string& name, std::string_view file) {
    add(name, "file://" + (folder_ / file).string());
  };
  add("auth.plugin", "builtin.PKI-DH");
  add_file("auth.builtin.PKI-DH.identity_ca", kCa);
  add_file("auth.builtin.PKI-DH.identity_certificate", kCertificate);
  add_file("auth.builtin.PKI-DH.identity_crl", kRevoked);
  add_file("auth.builtin.PKI-DH.private_key", kKey);
  add("access.plugin", "builtin.Access-Permissions");
  add_file("access.builtin.Access-Permissions.permissions_ca", kCa);
  add_file("access.builtin.Access-Permissions.governance", kGovernance);
  add_file("access.builtin.Access-Permissions.permissions", kPermissions);
  add("crypto.plugin", "builtin.AES-GCM-GMAC");
}

FleetKeys::GuidBegin FleetKeys::guid_begin(FleetRole role, const std::string& name) const {
  const Subject subject(X509_NAME_new());
  add_entry(subject.get(), "O", fleet_);
  add_entry(subject.get(), "OU", role_name(role));
  add_entry(subject.get(), "CN", name);
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> hash{};
  unsigned int size = 0;
  X509_NAME_digest(subject.get(), EVP_sha256(), hash.data(), &size);
  GuidBegin begin{};
  std::uint8_t before = 1;  // the bit that says that the rest is a hash
  for (std::size_t i = 0; i < begin.size(); ++i) {
    begin[i] = static_cast<std::uint8_t>((before << 7U) | (hash[i] >> 1U));
    before = hash[i];
  }
  return begin;
}

}  // namespace fleetloc
