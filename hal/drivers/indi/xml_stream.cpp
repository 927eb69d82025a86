// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/xml_stream.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <charconv>
#include <cstring>
#include <utility>

#include "engine/error.hpp"
#include "hal/drivers/indi/base64.hpp"

namespace fathom::indi {
namespace {

// Far beyond what drivers send; small enough to be harmless.
constexpr std::size_t kLongestText = 64 * 1024;   // of a member
constexpr std::size_t kLongestTag = 64 * 1024;    // with its attributes
constexpr std::size_t kMostMembers = 4096;        // of one element
constexpr std::size_t kLongestElement = 1 << 20;  // texts and attributes of all members
// The parser keeps every name that it has seen, and there are few in INDI.
constexpr int kMostStrangers = 10'000;

std::string found(const std::map<std::string, std::string>& attributes, const std::string& name) {
  const auto attribute = attributes.find(name);
  return attribute == attributes.end() ? "" : attribute->second;
}

std::string_view trimmed(std::string_view text) {
  constexpr const char* kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  for (const std::string_view known : names) {
    if (name == known) return true;
  }
  return false;
}

bool is_known_name(std::string_view name) {
  if (name.ends_with("Vector") || name.starts_with("def") || name.starts_with("one")) {
    return name.size() <= 16;
  }
  return is_one_of(
      name, {"message", "delProperty", "getProperties", "enableBLOB", "pingRequest", "pingReply"});
}

bool is_known_attribute(std::string_view name) {
  return is_one_of(
      name, {"device", "name", "label", "group", "state", "perm", "rule", "timeout", "timestamp",
             "message", "format", "min", "max", "step", "size", "len", "enclen", "version", "uid"});
}

}  // namespace

std::string Member::attribute(const std::string& name) const { return found(attributes, name); }
std::string Element::attribute(const std::string& name) const { return found(attributes, name); }

/// What expat calls. No exception may pass through it: a problem is kept, and the parser stopped.
struct XmlStream::Reader {
  XML_Parser parser = XML_ParserCreate(nullptr);
  std::vector<Element> ready;
  Element element;
  Base64Decoder base64;
  std::string problem;
  std::size_t blob_limit = 0;
  std::size_t text_bytes = 0;  // of the element, without its BLOBs
  std::size_t blob_bytes = 0;  // of all BLOBs of the element
  std::int64_t fed_bytes = 0;
  int depth = 0;  // 1: between elements; 2: in one; 3: in its member
  int strangers = 0;

  Reader() {
    if (parser == nullptr) throw Error(ErrorCode::out_of_memory, "no memory for an XML parser");
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, on_start, on_end);
    XML_SetCharacterDataHandler(parser, on_text);
  }
  ~Reader() { XML_ParserFree(parser); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  void stop(std::string why) {
    if (problem.empty()) problem = std::move(why);
    XML_StopParser(parser, XML_FALSE);
  }

  static void on_start(void* user, const XML_Char* name, const XML_Char** attributes) {
    auto& reader = *static_cast<Reader*>(user);
    try {
      reader.start(name, attributes);
    } catch (const std::exception& error) {
      reader.stop(error.what());
    }
  }
  static void on_end(void* user, const XML_Char*) {
    auto& reader = *static_cast<Reader*>(user);
    try {
      reader.end();
    } catch (const std::exception& error) {
      reader.stop(error.what());
    }
  }
  static void on_text(void* user, const XML_Char* text, int length) {
    auto& reader = *static_cast<Reader*>(user);
    try {
      reader.text({text, static_cast<std::size_t>(length)});
    } catch (const std::exception& error) {
      reader.stop(error.what());
    }
  }

  std::map<std::string, std::string> read(const XML_Char** attributes) {
    std::map<std::string, std::string> values;
    for (; *attributes != nullptr; attributes += 2) {
      if (!is_known_attribute(attributes[0])) {
        ++strangers;
      } else {
        values[attributes[0]] = attributes[1];
        count_text(std::strlen(attributes[1]));
      }
    }
    return values;
  }

  /// Each member may be small, and there may be many.
  void count_text(std::size_t bytes) {
    text_bytes += bytes;
    if (text_bytes > kLongestElement) stop("an element of more than 1 MiB");
  }

  void start(const char* name, const XML_Char** attributes) {
    if (depth > 0 && !is_known_name(name)) ++strangers;
    if (++depth == 2) {
      text_bytes = blob_bytes = 0;
      element = {name, read(attributes), {}};
    } else if (depth == 3) {
      if (element.members.size() == kMostMembers) return stop("an element with too many members");
      element.members.emplace_back().attributes = read(attributes);
      base64 = {};
      if (is_blob()) check_size(element.members.back().attribute("size"));
    } else if (depth > 3) {
      return stop("elements within members");
    }
    if (strangers > kMostStrangers) stop("too many names that are not INDI's");
  }

  bool is_blob() const { return element.tag == "setBLOBVector"; }

  /// Believes a server that announces too much: its picture is not waited for.
  void check_size(const std::string& text) {
    std::uint64_t size = 0;
    std::from_chars(text.data(), text.data() + text.size(), size);
    if (blob_limit > 0 && size > blob_limit) refuse_blob(size);
  }

  void refuse_blob(std::uint64_t size) {
    stop(fmt::format("a picture of {} bytes or more, where {} at most are expected", size,
                     blob_limit));
  }

  void text(std::string_view piece) {
    if (depth != 3) return;
    Member& member = element.members.back();
    if (!is_blob()) {
      member.text += piece;
      if (member.text.size() > kLongestText) stop("a member of more than 64 KiB");
      count_text(piece.size());
    } else if (blob_limit > 0) {
      const std::size_t before = member.bytes.size();
      base64.decode(piece, member.bytes);
      blob_bytes += member.bytes.size() - before;
      if (blob_bytes > blob_limit) refuse_blob(blob_bytes);
    }
  }

  void end() {
    --depth;
    if (depth == 2) {
      Member& member = element.members.back();
      member.text = trimmed(member.text);
      member.is_damaged = is_blob() && !base64.is_complete();
    } else if (depth == 1) {
      ready.push_back(std::move(element));
    }
  }

  void feed(std::string_view piece) {
    fed_bytes += static_cast<std::int64_t>(piece.size());
    const XML_Status status =
        XML_Parse(parser, piece.data(), static_cast<int>(piece.size()), XML_FALSE);
    if (status != XML_STATUS_OK && problem.empty()) {
      problem = fmt::format("no XML: {}", XML_ErrorString(XML_GetErrorCode(parser)));
    }
    if (!problem.empty()) throw Error(ErrorCode::bad_data, "the INDI server sent " + problem);
    // What expat has not used yet it keeps: a tag that never ends.
    if (fed_bytes - XML_GetCurrentByteIndex(parser) >
        static_cast<std::int64_t>(kLongestTag + piece.size())) {
      stop("a tag of more than 64 KiB");
      throw Error(ErrorCode::bad_data, "the INDI server sent " + problem);
    }
  }
};

XmlStream::XmlStream() : reader_(std::make_unique<Reader>()) {
  // INDI's elements follow each other without one that holds them all, which XML asks for. It also
  // puts a DOCTYPE, and with it every entity that grows, out of place.
  reader_->feed("<indi>");
}
XmlStream::~XmlStream() = default;

void XmlStream::set_blob_limit(std::size_t bytes) { reader_->blob_limit = bytes; }

std::vector<Element> XmlStream::feed(std::string_view piece) {
  constexpr std::size_t kPiece = 64 * 1024;
  for (; !piece.empty(); piece.remove_prefix(std::min(kPiece, piece.size()))) {
    reader_->feed(piece.substr(0, kPiece));
  }
  return std::exchange(reader_->ready, {});
}

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&apos;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace fathom::indi
