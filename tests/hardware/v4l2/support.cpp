// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "tests/hardware/usb/commands.hpp"

namespace fathom::test {
namespace {

using namespace std::chrono_literals;

/// A file of our own, beside the one that the driver under test has open.
class Node {
 public:
  explicit Node(const std::string& path)
      : descriptor_(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error("cannot open " + path);
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node() { ::close(descriptor_); }

  template <class Argument>
  bool call(unsigned long request, Argument& argument) const {
    return ::ioctl(descriptor_, request, &argument) == 0;
  }

 private:
  int descriptor_;
};

std::string socket_path() {
  const char* const path = std::getenv("FATHOM_USB_SOCKET");
  return path != nullptr ? path : "";
}

}  // namespace

std::string device_file(const char* variable) {
  const char* const path = std::getenv(variable);
  return path != nullptr ? path : "";
}

Hardware open_v4l2(std::map<std::string, std::string> keys, const OpenOptions& options) {
  std::string text = "v4l2:device=" + keys.at("device");
  keys.erase("device");
  for (const auto& [key, value] : keys) text.append(",").append(key).append("=").append(value);
  return open_hardware(text, options);
}

Frame frame_after(Camera& camera, std::int64_t settled_ns) {
  for (int i = 0; i < 100; ++i) {
    std::optional<Frame> frame = camera.grab(5s);
    if (!frame) break;
    if (frame->exposure.start_ns >= settled_ns) return std::move(*frame);
  }
  ADD_FAILURE() << "no fresh frame";
  return {};
}

void usb(const std::string& command) {
  EXPECT_EQ(usb::command(socket_path(), command), "ok") << command;
}

double camera_status(const std::string& name) {
  const std::string status = usb::command(socket_path(), "status");
  const std::size_t at = (" " + status).find(" " + name + "=");
  if (at == std::string::npos) throw std::runtime_error("no " + name + " in " + status);
  return std::stod(status.substr(at + name.size() + 1));
}

void set_control(const std::string& path, const std::string& name, int value) {
  const Node node(path);
  v4l2_queryctrl query{};
  query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
  for (; node.call(VIDIOC_QUERYCTRL, query); query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
    if (name != reinterpret_cast<const char*>(query.name)) continue;
    v4l2_control control{query.id, value};
    EXPECT_TRUE(node.call(VIDIOC_S_CTRL, control)) << name << ": " << std::strerror(errno);
    return;
  }
  ADD_FAILURE() << path << " has no control \"" << name << '"';
}

int get_control(const std::string& path, std::uint32_t id) {
  v4l2_control control{id, 0};
  EXPECT_TRUE(Node(path).call(VIDIOC_G_CTRL, control)) << std::strerror(errno);
  return control.value;
}

bool can_be_opened(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return false;
  v4l2_capability capability{};
  const bool answers = ::ioctl(descriptor, VIDIOC_QUERYCAP, &capability) == 0;
  ::close(descriptor);
  return answers;
}

std::string device_folder(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path interface =
      fs::canonical("/sys/class/video4linux" / fs::path(path).filename() / "device");
  return interface.parent_path();
}

bool eventually(const std::function<bool()>& holds) {
  for (int i = 0; i < 200; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(50ms);
  }
  return false;
}

std::chrono::milliseconds time_of(const std::function<void()>& call) {
  const auto before = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() -
                                                               before);
}

}  // namespace fathom::test
