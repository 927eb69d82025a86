// SPDX-License-Identifier: Apache-2.0
// INDI's stream of XML elements, read as it comes, in bounded memory.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::indi {

/// What an INDI element holds between its tags: <oneNumber name="X">12</oneNumber>.
struct Member {
  std::map<std::string, std::string> attributes;
  std::string text;              ///< Without white space round it; empty for a BLOB,
  std::vector<std::byte> bytes;  ///< whose decoded bytes are here.
  bool is_damaged = false;       ///< A BLOB that is no base64.

  std::string attribute(const std::string& name) const;
};

/// One element of the stream: <setNumberVector device="..." ...>members</setNumberVector>.
struct Element {
  std::string tag;
  std::map<std::string, std::string> attributes;
  std::vector<Member> members;

  std::string attribute(const std::string& name) const;
};

/// A server is a stranger: whatever it sends costs a bounded amount of memory, and what is not
/// INDI's XML is an Error. After an Error the stream is over: where the next element begins,
/// nobody knows.
class XmlStream {
 public:
  XmlStream();
  ~XmlStream();
  XmlStream(const XmlStream&) = delete;
  XmlStream& operator=(const XmlStream&) = delete;

  /// The largest BLOB that is believed, bytes, and all BLOBs of one element together; 0, as at first: BLOBs are skipped, whatever their
  /// size.
  void set_blob_limit(std::size_t bytes);

  /// Reads the next piece and returns the elements that it completes. Throws Error(bad_data) for
  /// what is no XML or goes beyond a limit.
  std::vector<Element> feed(std::string_view piece);

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

/// `text` with the five characters that XML reserves written so that they are read back as they
/// were.
std::string xml_escaped(std::string_view text);

}  // namespace fathom::indi
