// SPDX-License-Identifier: Apache-2.0
#include "io/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "io/cursor.hpp"

namespace delfront {

namespace {

constexpr int kMaxDepth = 64;
constexpr std::string_view kAppended = "AppendedData";
constexpr std::string_view kCdata = "<![CDATA[", kCdataEnd = "]]>";

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool ends_name(char c) { return is_space(c) || c == '=' || c == '>' || c == '/' || c == '<'; }

void append_utf8(std::string& out, std::uint32_t code) {
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xc0 | (code >> 6));
    out += static_cast<char>(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    out += static_cast<char>(0xe0 | (code >> 12));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3f));
    out += static_cast<char>(0x80 | (code & 0x3f));
  } else {
    out += static_cast<char>(0xf0 | ((code >> 18) & 7));
    out += static_cast<char>(0x80 | ((code >> 12) & 0x3f));
    out += static_cast<char>(0x80 | ((code >> 6) & 0x3f));
    out += static_cast<char>(0x80 | (code & 0x3f));
  }
}

}  // namespace

std::string unescape_xml(std::string_view text) {
  constexpr std::size_t kLongest = 11;  // characters of an entity
  static constexpr std::pair<std::string_view, char> kEntities[] = {
      {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t length = text[i] == '&' ? text.substr(i, kLongest).find(';') : std::string_view::npos;
    if (length == std::string_view::npos) {
      out += text[i];
      continue;
    }
    std::string_view entity = text.substr(i + 1, length - 1);
    const auto known = std::find_if(std::begin(kEntities), std::end(kEntities),
                                    [&](const auto& pair) { return pair.first == entity; });
    std::uint32_t code = 0;
    if (known != std::end(kEntities)) {
      code = static_cast<unsigned char>(known->second);
    } else if (entity.starts_with('#')) {
      const int base = entity.size() > 1 && entity[1] == 'x' ? 16 : 10;
      entity.remove_prefix(std::min<std::size_t>(base == 16 ? 2 : 1, entity.size()));
      std::from_chars(entity.data(), entity.data() + entity.size(), code, base);
    }
    if (code == 0) {
      out += text[i];
      continue;
    }
    append_utf8(out, code);
    i += length;
  }
  return out;
}

namespace {

class XmlParser {
 public:
  XmlParser(std::string_view bytes, const std::string& path) : cursor_(bytes, path), bytes_(bytes) {}

  XmlElement parse() {
    skip_to_element();
    if (at_ >= bytes_.size()) fail("no XML element: this is no XML file");
    XmlElement root;
    parse_element(root, 0);
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { cursor_.fail_at(at_, message); }

  void skip_spaces() {
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
  }
  bool looking_at(std::string_view text) const { return bytes_.substr(at_, text.size()) == text; }
  void skip_past(std::string_view text) {
    const std::size_t found = bytes_.find(text, at_);
    if (found == std::string_view::npos) fail(fmt::format("the file ends before '{}'; it is truncated", text));
    at_ = found + text.size();
  }

  /// To the next '<' that opens or closes an element, over comments, declarations and text.
  void skip_to_element() {
    while (at_ < bytes_.size()) {
      if (looking_at("<!--")) {
        skip_past("-->");
      } else if (looking_at(kCdata)) {
        skip_past(kCdataEnd);
      } else if (looking_at("<?") || looking_at("<!")) {
        skip_past(">");
      } else if (bytes_[at_] == '<') {
        return;
      } else {
        at_ = std::min(bytes_.find('<', at_), bytes_.size());
      }
    }
  }

  std::string_view name() {
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !ends_name(bytes_[at_])) ++at_;
    if (at_ == begin) fail("a name is missing in a tag; the XML is damaged");
    return bytes_.substr(begin, at_ - begin);
  }

  /// @return true where the tag closes itself
  bool parse_attributes(XmlElement& element) {
    for (;;) {
      skip_spaces();
      if (looking_at("/>")) {
        at_ += 2;
        return true;
      }
      if (looking_at(">")) {
        ++at_;
        return false;
      }
      const std::string_view attribute = name();
      skip_spaces();
      if (!looking_at("=")) fail(fmt::format("'=' is missing after attribute {}", attribute.substr(0, 40)));
      ++at_;
      skip_spaces();
      if (at_ >= bytes_.size() || (bytes_[at_] != '"' && bytes_[at_] != '\''))
        fail("an attribute's value has no quotes");
      const char quote = bytes_[at_++];
      const std::size_t end = bytes_.find(quote, at_);
      if (end == std::string_view::npos) fail("the file ends inside an attribute; it is truncated");
      element.attributes.emplace_back(attribute, unescape_xml(bytes_.substr(at_, end - at_)));
      at_ = end + 1;
    }
  }

  void parse_element(XmlElement& element, int depth) {
    if (depth > kMaxDepth) fail("elements are nested too deep");
    ++at_;  // '<'
    element.name = name();
    if (parse_attributes(element)) return;
    if (element.name == kAppended) return take_appended(element);
    const std::size_t text_begin = at_;
    element.text = bytes_.substr(at_, std::min(bytes_.find('<', at_), bytes_.size()) - text_begin);
    if (bytes_.substr(at_ + element.text.size()).starts_with(kCdata)) take_cdata(element);
    for (;;) {
      skip_to_element();
      if (at_ >= bytes_.size())
        fail(fmt::format("the file ends before </{}>; it is truncated", element.name.substr(0, 40)));
      if (looking_at("</")) break;
      element.children.emplace_back();
      parse_element(element.children.back(), depth + 1);
      if (ended_) return;
    }
    at_ += 2;
    if (name() != element.name) fail(fmt::format("</{}> is missing", element.name.substr(0, 40)));
    skip_past(">");
  }

  /// Text as it stands, where nothing else stands before it.
  void take_cdata(XmlElement& element) {
    if (!std::all_of(element.text.begin(), element.text.end(), is_space)) return;
    at_ += element.text.size() + kCdata.size();
    const std::size_t begin = at_;
    skip_past(kCdataEnd);
    element.text = bytes_.substr(begin, at_ - kCdataEnd.size() - begin);
    element.is_cdata = true;
  }

  void take_appended(XmlElement& element) {
    skip_past("_");
    element.text = bytes_.substr(at_);
    ended_ = true;
  }

  Cursor cursor_;  // for messages
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool ended_ = false;
};

}  // namespace

const std::string* XmlElement::find(std::string_view attribute) const {
  for (const auto& [key, value] : attributes)
    if (key == attribute) return &value;
  return nullptr;
}

std::string XmlElement::get(std::string_view attribute) const {
  const std::string* value = find(attribute);
  return value ? *value : "";
}

const XmlElement* XmlElement::child(std::string_view wanted) const {
  for (const XmlElement& candidate : children)
    if (candidate.name == wanted) return &candidate;
  return nullptr;
}

XmlElement parse_xml(std::string_view bytes, const std::string& path) { return XmlParser(bytes, path).parse(); }

std::string escape_xml(std::string_view text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\t':
      case '\n':
      case '\r':
        out += fmt::format("&#{};", static_cast<int>(c));
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace delfront
