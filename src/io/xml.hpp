// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace delfront {

/// @brief An element of the small part of XML that VTK and XDMF files use: attributes, children, text. Views into the
/// bytes.
struct XmlElement {
  std::string_view name;
  std::vector<std::pair<std::string_view, std::string>> attributes;  ///< values with entities resolved
  std::vector<XmlElement> children;
  std::string_view text;  ///< as it stands between the tags, up to the first child; or what a CDATA section there holds
  bool is_cdata = false;  ///< `text` has no entities

  /// @return the attribute's value, or nullptr
  const std::string* find(std::string_view attribute) const;
  /// @return "" where it is not there
  std::string get(std::string_view attribute) const;
  const XmlElement* child(std::string_view wanted) const;
};

/// @brief Parse a document up to its end or to <AppendedData>, whose raw bytes are no XML.
///
/// The element AppendedData, if any, is the root's last child; its `text` begins after the '_' that marks the data
/// and goes to the end of the file.
/// @throws InputError  not well formed (line), nested over 64 deep
XmlElement parse_xml(std::string_view bytes, const std::string& path);

/// @brief &, <, >, ", tabs and ends of lines as entities, for text and for values of attributes.
std::string escape_xml(std::string_view text);

/// @brief Resolves &lt; &#65; &#x41; and so on; what is no entity stays as it is.
std::string unescape_xml(std::string_view text);

}  // namespace delfront
