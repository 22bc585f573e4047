// SPDX-License-Identifier: Apache-2.0
#include "xml.h"

#include <expat.h>

#include <memory>
#include <optional>
#include <type_traits>

namespace nonio::spreadsheet {

namespace {

constexpr std::size_t piece = 1 << 20;

std::string_view without_prefix(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

class Handlers {
 public:
  Handlers(XML_Parser parser, const std::function<Expected<void>(const Node&)>& take)
      : parser_(parser), take_(take) {
    XML_SetUserData(parser, this);
    XML_SetElementHandler(parser, &Handlers::begins, &Handlers::ends);
    XML_SetCharacterDataHandler(parser, &Handlers::text);
    XML_SetStartDoctypeDeclHandler(parser, &Handlers::doctype);
  }
  const std::optional<Error>& error() const { return error_; }

 private:
  static void begins(void* self, const char* name, const char** attributes) {
    Node node{Node::Kind::begins, without_prefix(name), {}, {}};
    node.attribute = [attributes](const char* wanted) {
      for (const char** at = attributes; *at != nullptr; at += 2)
        if (std::string_view(wanted) == at[0]) return std::string(at[1]);
      return std::string();
    };
    static_cast<Handlers*>(self)->give(node);
  }
  static void ends(void* self, const char* name) {
    static_cast<Handlers*>(self)->give({Node::Kind::ends, without_prefix(name), {}, {}});
  }
  static void text(void* self, const char* text, int length) {
    const std::string_view all(text, static_cast<std::size_t>(length));
    static_cast<Handlers*>(self)->give({Node::Kind::text, {}, all, {}});
  }
  static void doctype(void* self, const char*, const char*, const char*, int) {
    static_cast<Handlers*>(self)->stop(
        {"the XML of the spreadsheet has a document type or entities: it is not read"});
  }
  void give(const Node& node) {
    if (error_) return;
    if (auto taken = take_(node); !taken) stop(taken.error());
  }
  void stop(Error error) {
    error_ = std::move(error);
    XML_StopParser(parser_, XML_FALSE);
  }

  XML_Parser parser_;
  const std::function<Expected<void>(const Node&)>& take_;
  std::optional<Error> error_;
};

}  // namespace

Expected<void> read_xml(std::string_view xml,
                        const std::function<Expected<void>(const Node&)>& take,
                        const std::function<bool()>& enough) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  if (!parser) return fail("the XML of the spreadsheet cannot be read");
  const Handlers handlers(parser.get(), take);
  for (std::size_t at = 0; at <= xml.size(); at += piece) {
    const std::string_view now = xml.substr(at, piece);
    const bool last = at + piece > xml.size();
    const auto status =
        XML_Parse(parser.get(), now.data(), static_cast<int>(now.size()), last ? 1 : 0);
    if (handlers.error()) return fail(*handlers.error());
    if (enough()) return {};
    if (status != XML_STATUS_OK)
      return fail("the XML of the spreadsheet is damaged (" +
                  std::string(XML_ErrorString(XML_GetErrorCode(parser.get()))) + ")");
  }
  return {};
}

}  // namespace nonio::spreadsheet
