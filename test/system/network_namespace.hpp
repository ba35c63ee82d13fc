#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fleetloc {

/// A file descriptor that is closed with this object.
class OwnedDescriptor {
 public:
  explicit OwnedDescriptor(int number) : number_(number) {}
  ~OwnedDescriptor();
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

/// A network namespace, with its loopback up. It ends with this object and the programs that were
/// started in it.
class NetworkNamespace {
 public:
  /// Why namespaces cannot be made here; nothing if they can.
  static std::optional<std::string> why_impossible();

  NetworkNamespace();

  /// While it lives, this thread is in the namespace, and so are the programs that it starts.
  class Scope {
   public:
    explicit Scope(const NetworkNamespace& inside);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    OwnedDescriptor before_;
  };
  [[nodiscard]] Scope enter() const { return Scope(*this); }

  /// Runs `ip` with these words inside. Throws std::runtime_error with what it said.
  void ip(const std::string& words) const;
  /// For ip() of another one.
  [[nodiscard]] std::string path() const;

 private:
  OwnedDescriptor namespace_;
};

/// Computers on one switch.
class SwitchedNetwork {
 public:
  /// @param carries_multicast  no: as most virtual networks
  explicit SwitchedNetwork(bool carries_multicast);

  /// Gives a computer the interface `eth0`.
  /// @param address  e.g. 10.77.0.1; all of them in one network of 24 bits
  void plug_in(const NetworkNamespace& computer, const std::string& address);
  /// Takes it away. The others do not notice.
  static void pull_out(const NetworkNamespace& computer);

 private:
  NetworkNamespace switch_;
  bool carries_multicast_;
  int ports_ = 0;
};

}  // namespace fleetloc
