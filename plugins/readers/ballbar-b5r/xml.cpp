// SPDX-License-Identifier: Apache-2.0
#include "xml.h"

#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <libxml/xmlerror.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include "nonio/sdk/text.h"
#include "runs.h"

namespace nonio::ballbar {
using namespace readers;

namespace {

/// Without white space at the ends.
std::string_view stripped(std::string_view text) {
  constexpr std::string_view white = " \t\r\n";
  const std::size_t first = text.find_first_not_of(white);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(white) - first + 1);
}

std::string_view view(const xmlChar* text) {
  return text == nullptr ? std::string_view() : reinterpret_cast<const char*>(text);
}

std::string qualified(const xmlChar* prefix, const xmlChar* name) {
  return prefix == nullptr ? std::string(view(name))
                           : std::string(view(prefix)) + ":" + std::string(view(name));
}

/// What libxml2 calls back for one document; its first complaint counts, what follows comes of it.
struct Handler {
  const TakeElement& take;
  xmlParserCtxtPtr parser = nullptr;
  std::vector<Element> open = {};
  std::uint64_t elements = 0;
  std::optional<Error> error = std::nullopt;

  void refuse(Error why) {
    if (!error) error = std::move(why);
    xmlStopParser(parser);
  }
};

Handler& handler(void* data) { return *static_cast<Handler*>(data); }

void on_start(void* data, const xmlChar* name, const xmlChar* prefix, const xmlChar*, int,
              const xmlChar**, int count, int, const xmlChar** attributes) {
  Handler& h = handler(data);
  Element element;
  element.name = qualified(prefix, name);
  element.number = ++h.elements;
  element.line = static_cast<std::uint64_t>(xmlSAX2GetLineNumber(h.parser));
  for (int i = 0; i < count; ++i) {  // five pointers each: name, prefix, URI, value from and to
    const xmlChar** const a = attributes + std::ptrdiff_t{5} * i;
    element.attributes.emplace_back(
        qualified(a[1], a[0]), std::string(view(a[3]), 0, static_cast<std::size_t>(a[4] - a[3])));
  }
  h.open.push_back(std::move(element));
}

void on_end(void* data, const xmlChar*, const xmlChar*, const xmlChar*) {
  Handler& h = handler(data);
  if (h.open.empty()) return;
  Element element = std::move(h.open.back());
  h.open.pop_back();
  element.text = std::string(stripped(element.text));
  h.take(element, h.open);
}

void on_text(void* data, const xmlChar* text, int size) {
  Handler& h = handler(data);
  if (!h.open.empty()) h.open.back().text.append(view(text).data(), static_cast<std::size_t>(size));
}

void on_document_type(void* data, const xmlChar*, const xmlChar*, const xmlChar*) {
  Handler& h = handler(data);
  h.refuse(at_line(static_cast<std::uint64_t>(xmlSAX2GetLineNumber(h.parser)),
                   "expected no document type in a measurement's file"));
}

void on_error(void* data, xmlErrorPtr found) {
  Handler& h = handler(data);
  if (h.error || found->level < XML_ERR_ERROR || found->domain == XML_FROM_NAMESPACE) return;
  const bool cut = found->code == XML_ERR_TAG_NOT_FINISHED || found->code == XML_ERR_DOCUMENT_END ||
                   found->code == XML_ERR_DOCUMENT_EMPTY;
  std::string what(stripped(found->message == nullptr ? "" : found->message));
  std::replace_if(
      what.begin(), what.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  h.error =
      at_line(static_cast<std::uint64_t>(std::max(found->line, 1)),
              "expected well-formed XML, found: " + what + (cut ? "; was the file cut?" : ""));
}

xmlSAXHandler callbacks() {
  xmlSAXHandler sax{};
  sax.initialized = XML_SAX2_MAGIC;
  sax.startElementNs = on_start;
  sax.endElementNs = on_end;
  sax.characters = on_text;
  sax.ignorableWhitespace = on_text;
  sax.cdataBlock = on_text;
  sax.internalSubset = on_document_type;
  sax.serror = on_error;
  return sax;
}

}  // namespace

std::string Element::attribute(std::string_view key) const {
  for (const auto& [its_name, value] : attributes)
    if (its_name == key) return value;
  return {};
}

Expected<void> for_each_element(std::string_view bytes, const TakeElement& take) {
  if (bytes.find('\0') != bytes.npos || !is_utf8(bytes) ||
      bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return fail("expected XML in UTF-8, found other bytes; is the file UTF-16?");
  if (bytes.empty()) return fail("expected an XML document, found an empty file");
  const std::unique_ptr<xmlParserCtxt, decltype(&xmlFreeParserCtxt)> parser(
      xmlCreateMemoryParserCtxt(bytes.data(), static_cast<int>(bytes.size())), xmlFreeParserCtxt);
  if (!parser) return fail("there is no memory for a parser of XML");
  Handler h{take, parser.get()};
  xmlSAXHandler sax = callbacks();
  *parser->sax = sax;
  parser->userData = &h;
  // No file and no address is opened, whatever the document says; without XML_PARSE_HUGE depth
  // (256) and sizes have the library's limits.
  xmlCtxtUseOptions(parser.get(), XML_PARSE_NONET | XML_PARSE_IGNORE_ENC);
  xmlParseDocument(parser.get());
  if (h.error) return fail(std::move(*h.error));
  if (parser->wellFormed == 0) return fail("expected well-formed XML, found none");
  return {};
}

}  // namespace nonio::ballbar
