// SPDX-License-Identifier: Apache-2.0
#include "nonio/sign/dcc.h"

#include <charconv>

#include "nonio/sdk/dsi_units.h"
#include "xml_document.h"

namespace nonio::sign {

namespace {

std::string_view name_of(const xmlNode* node) { return reinterpret_cast<const char*>(node->name); }

const xmlNode* child(const xmlNode* node, std::string_view name) {
  for (const xmlNode* c = node == nullptr ? nullptr : node->children; c != nullptr; c = c->next)
    if (c->type == XML_ELEMENT_NODE && name_of(c) == name) return c;
  return nullptr;
}

std::string content_of(const xmlNode* node) {
  if (node == nullptr) return {};
  xmlChar* content = xmlNodeGetContent(node);
  std::string out = content == nullptr ? "" : reinterpret_cast<const char*>(content);
  xmlFree(content);
  return out;
}

std::string title_of(const xmlNode* node) {
  return content_of(child(child(node, "name"), "content"));
}

Expected<double> number(const std::string& text) {
  double value = 0.0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size() ||
      !(value - value == 0.0))
    return fail("expected a number, found \"" + text.substr(0, 40) + "\"");
  return value;
}

std::size_t words_in(const std::string& text) {
  std::size_t words = 0;
  bool inside = false;
  for (const char c : text) {
    const bool space = c == ' ' || c == '\n' || c == '\t' || c == '\r';
    words += !space && !inside ? 1 : 0;
    inside = !space;
  }
  return words;
}

Expected<std::string> unit(const std::string& dsi) {
  for (const auto& [ours, theirs] : dsi_units)
    if (theirs == dsi) return std::string(ours);
  return fail("the unit \"" + dsi.substr(0, 60) + "\" is none that D-SI has here");
}

class Reader {
 public:
  Expected<std::vector<DccValue>> read(const xmlNode* root) {
    if (name_of(root) != "digitalCalibrationCertificate") return fail("is no DCC");
    const xmlNode* results = child(root, "measurementResults");
    for (const xmlNode* r = results == nullptr ? nullptr : results->children; r != nullptr;
         r = r->next) {
      if (r->type != XML_ELEMENT_NODE || name_of(r) != "measurementResult") continue;
      // The name is text for readers; the description, if present, identifies the analysis.
      const xmlNode* description = child(r, "description");
      analysis_ = description == nullptr ? title_of(r) : content_of(child(description, "content"));
      if (auto done = read_data(child(child(child(r, "results"), "result"), "data")); !done)
        return fail(done.error());
    }
    if (values_.empty()) return fail("holds no value");
    return std::move(values_);
  }

 private:
  tl::unexpected<Error> in(const std::string& name, const Error& why) const {
    return fail(analysis_ + " " + name + ": " + why.message);
  }

  Expected<void> read_data(const xmlNode* data) {
    for (const xmlNode* c = data == nullptr ? nullptr : data->children; c != nullptr; c = c->next) {
      if (c->type != XML_ELEMENT_NODE) continue;
      auto done = name_of(c) == "quantity" ? read_value(c)
                  : name_of(c) == "list"   ? read_list(c)
                                           : Expected<void>{};
      if (!done) return done;
    }
    return {};
  }

  Expected<void> read_value(const xmlNode* quantity) {
    const xmlNode* real = child(quantity, "real");
    DccValue v{analysis_, title_of(quantity), {}, 0.0, {}};
    const auto value = number(content_of(child(real, "value")));
    if (!value) return in(v.name, value.error());
    auto symbol = unit(content_of(child(real, "unit")));
    if (!symbol) return in(v.name, symbol.error());
    v.value = *value;
    v.unit = std::move(*symbol);
    const xmlNode* expanded = child(child(real, "measurementUncertaintyUnivariate"), "expandedMU");
    if (expanded != nullptr) {
      const auto U = number(content_of(child(expanded, "valueExpandedMU")));
      if (!U) return in(v.name, U.error());
      const auto k = number(content_of(child(expanded, "coverageFactor")));
      if (!k) return in(v.name, k.error());
      if (!(*k >= 1.0)) return in(v.name, {"expected a coverage factor of 1 or more"});
      v.U = *U;
      v.k = *k;
    }
    values_.push_back(std::move(v));
    return {};
  }

  Expected<void> read_list(const xmlNode* list) {
    std::size_t length = 0;
    for (const xmlNode* q = list->children; q != nullptr; q = q->next) {
      if (q->type != XML_ELEMENT_NODE || name_of(q) != "quantity") continue;
      const xmlNode* values = child(q, "realListXMLList");
      const std::size_t n = words_in(content_of(child(values, "valueXMLList")));
      if (const auto symbol = unit(content_of(child(values, "unitXMLList"))); !symbol)
        return in(title_of(q), symbol.error());
      if (n == 0 || (length != 0 && n != length))
        return in(title_of(q), {"a list of " + std::to_string(n) + " values next to one of " +
                                std::to_string(length)});
      length = n;
    }
    return {};
  }

  std::string analysis_;
  std::vector<DccValue> values_;
};

}  // namespace

Expected<std::vector<DccValue>> read_dcc(std::string_view xml) {
  NONIO_TRY(const auto document, parse_xml(xml));
  return Reader().read(xmlDocGetRootElement(document.get()));
}

}  // namespace nonio::sign
