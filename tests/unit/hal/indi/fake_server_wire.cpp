// SPDX-License-Identifier: Apache-2.0
// What the fake server says and hears: connections, requests, properties and pictures as XML.
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "fake_server.hpp"

namespace fathom::test {
namespace {

std::string encoded(std::string_view bytes) {
  constexpr const char* kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kAlphabet[group >> (18 - 6 * k) & 63] : '=';
    }
    if (i % 54 == 51) text += '\n';
  }
  return text;
}

}  // namespace

void FakeServer::serve() {
  while (!is_over_) {
    std::vector<pollfd> waiting{{listener_, POLLIN, 0}};
    {
      const std::lock_guard guard(lock_);
      for (const Client& client : clients_) waiting.push_back({client.handle, POLLIN, 0});
    }
    poll(waiting.data(), waiting.size(), 2);
    const std::lock_guard guard(lock_);
    if ((waiting[0].revents & POLLIN) != 0) {
      const int handle = accept(listener_, nullptr, nullptr);
      clients_.push_back({handle, false, std::make_unique<indi::XmlStream>()});
    }
    for (std::size_t i = 1; i < waiting.size() && i - 1 < clients_.size(); ++i) {
      if (waiting[i].revents != 0 && clients_[i - 1].handle == waiting[i].fd) {
        read_from(clients_[i - 1]);
      }
    }
    std::erase_if(clients_, [](const Client& client) { return client.handle < 0; });
    tick();
  }
}

void FakeServer::read_from(Client& client) {
  std::array<char, 4096> room;
  const ssize_t count = recv(client.handle, room.data(), room.size(), MSG_DONTWAIT);
  if (count <= 0) {
    close(client.handle);
    client.handle = -1;
    return;
  }
  for (const indi::Element& element :
       client.stream->feed({room.data(), static_cast<std::size_t>(count)})) {
    take(client, element);
  }
}

void FakeServer::take(Client& client, const indi::Element& element) {
  const Key key{element.attribute("device"), element.attribute("name")};
  ++requests_[key.second];
  if (element.tag == "enableBLOB") client.wants_pictures = true;
  if (fault_ == Fault::no_answer || ignored_.contains(key.second)) return;
  if (element.tag == "getProperties") {
    for (const auto& [name, fake] : properties_) send_definition(client, name);
  } else if (element.tag.starts_with("new") && properties_.contains(key)) {
    change(key, element);
  }
}

void FakeServer::send_picture() {
  std::size_t size = picture_.size();
  if (fault_ == Fault::announces_gigabytes) size = 5'000'000'000;
  if (fault_ == Fault::short_picture) size += 2880;
  send_all(fmt::format("<setBLOBVector device='Cam' name='CCD1' state='Ok'>\n"
                       "<oneBLOB name='CCD1' size='{}' format='{}'>\n",
                       size, format_),
           true);
  if (fault_ == Fault::no_base64) send_all("*", true);
  std::string text = encoded(picture_);
  if (fault_ == Fault::close_in_picture) {
    send_all(text.substr(0, text.size() / 2), true);
    return hang_up();
  }
  // Enough at once that a busy machine sees more than was announced before its patience ends.
  const std::string much(1024, 'A');
  while (fault_ == Fault::endless_picture && !is_over_ && !clients_.empty()) {
    send_all(much, true);
    std::erase_if(clients_, [](const Client& client) { return client.handle < 0; });
  }
  send_all(text + "</oneBLOB></setBLOBVector>\n", true);
}

void FakeServer::send_definition(const Client& client, const Key& key) {
  const Fake& fake = properties_.at(key);
  std::string text = fmt::format("<def{}Vector device='{}' name='{}' state='{}' perm='rw'>",
                                 fake.kind, key.first, key.second, fake.state);
  for (const auto& [name, value] : fake.values) {
    text +=
        fmt::format("<def{0} name='{1}' {2}>\n{3}\n</def{0}>", fake.kind, name, fake.limits, value);
  }
  text += fmt::format("</def{}Vector>\n", fake.kind);
  send(client.handle, text.data(), text.size(), MSG_NOSIGNAL);
}

void FakeServer::send_state(const Key& key) {
  if (fault_ == Fault::no_answer) return;
  const Fake& fake = properties_.at(key);
  if (fake.kind == "BLOB") return;
  std::string text = fmt::format("<set{}Vector device='{}' name='{}' state='{}'>", fake.kind,
                                 key.first, key.second, fake.state);
  for (const auto& [name, value] : fake.values) {
    text += fmt::format("<one{0} name='{1}'>\n{2}\n</one{0}>", fake.kind, name, value);
  }
  send_all(text + fmt::format("</set{}Vector>\n", fake.kind));
}

void FakeServer::send_all(const std::string& text, bool only_pictures) {
  for (Client& client : clients_) {
    if (client.handle < 0 || (only_pictures && !client.wants_pictures)) continue;
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t sent =
          send(client.handle, text.data() + at, text.size() - at, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent > 0) {
        at += static_cast<std::size_t>(sent);
        continue;
      }
      pollfd room{client.handle, POLLOUT, 0};
      if (errno == EAGAIN && !is_over_ && poll(&room, 1, 1000) > 0 &&
          (room.revents & (POLLERR | POLLHUP)) == 0) {
        continue;
      }
      close(client.handle);
      client.handle = -1;
      break;
    }
  }
}

void FakeServer::hang_up() {
  for (Client& client : clients_) {
    if (client.handle >= 0) close(client.handle);
    client.handle = -1;
  }
}

}  // namespace fathom::test
