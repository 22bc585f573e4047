// SPDX-License-Identifier: Apache-2.0
#include "look.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>

namespace nonio::pages {
namespace {

using Names = std::vector<std::string>;

std::string joined(const Names& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

constexpr std::size_t longest_address = 200;  // limit for a QR code that can be read from paper

class Keys {
 public:
  Keys(const Settings& settings, std::string file) : settings_(settings), file_(std::move(file)) {}

  std::string text(const char* key) {
    const auto* value = find<std::string>(key, "a text");
    return value != nullptr ? *value : std::string();
  }

  std::string text_if_given(const char* key) {
    known_.insert(key);
    return settings_.has(key) ? text(key) : std::string();
  }

  /// An https URL to which a fragment can be added; empty if the key is missing.
  std::string address_if_given(const char* key) {
    const std::string address = text_if_given(key);
    constexpr std::string_view also = "-._~:/?[]@!$&'()*+,;=%";
    const bool plain = std::all_of(address.begin(), address.end(), [&](unsigned char c) {
      return c < 0x80 && (std::isalnum(c) != 0 || also.find(static_cast<char>(c)) != also.npos);
    });
    if (!address.empty() &&
        (!address.starts_with("https://") || !plain || address.size() > longest_address))
      complain(key, "an address that begins with https://, without \"#\" and blanks, of at most " +
                        std::to_string(longest_address) + " bytes");
    return address;
  }

  double number(const char* key, double least, double most) {
    known_.insert(key);
    const double value = settings_.number(key, std::nan(""));
    if (!(value >= least && value <= most))
      complain(key, "a number from " + std::to_string(static_cast<int>(least)) + " to " +
                        std::to_string(static_cast<int>(most)));
    return value;
  }
  double mm(const char* key, double least, double most) {
    return number(key, least, most) * 72.0 / 25.4;
  }

  Names any_names(const char* key) {
    known_.insert(key);
    const auto* value = settings_.has(key) ? find<Names>(key, "a list of names") : nullptr;
    return value != nullptr ? *value : Names();
  }

  Names names(const char* key, const Names& allowed) {
    const auto* value = find<Names>(key, "a list of names");
    if (value == nullptr) return {};
    for (const std::string& name : *value)
      if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
        complain(key, "names out of " + joined(allowed) + ", found \"" + name + "\"");
    return *value;
  }

  reports::Colour colour(const char* key) {
    const auto* value = find<std::string>(key, "a colour such as \"#1A5FA5\"");
    if (value == nullptr) return {};
    unsigned rgb = 0;
    const char* end = value->data() + value->size();
    if (value->size() != 7 || (*value)[0] != '#' ||
        std::from_chars(value->data() + 1, end, rgb, 16).ptr != end)
      complain(key, "a colour such as \"#1A5FA5\", found \"" + *value + "\"");
    const auto part = [&](int shift) { return static_cast<float>(rgb >> shift & 255) / 255.0F; };
    return {part(16), part(8), part(0)};
  }

  Expected<void> done() const {
    if (!error_.message.empty()) return fail(error_);
    for (const auto& [key, value] : settings_.values)
      if (!known_.contains(key))
        return fail(Error{"the key \"" + key + "\" is not known; known are " +
                              joined({known_.begin(), known_.end()}),
                          file_});
    return {};
  }

 private:
  template <class T>
  const T* find(const char* key, const char* wanted) {
    known_.insert(key);
    const auto it = settings_.values.find(key);
    const T* value = it == settings_.values.end() ? nullptr : std::get_if<T>(&it->second);
    if (value == nullptr) complain(key, wanted);
    return value;
  }
  void complain(const std::string& key, const std::string& wanted) {
    if (!error_.message.empty()) return;
    const bool there = settings_.has(key);
    error_ = {
        "the key \"" + key + "\" " + (there ? "should be " : "is missing; it should be ") + wanted,
        file_};
  }
  const Settings& settings_;
  std::string file_;
  std::set<std::string> known_;
  Error error_;
};

void read_style(Keys& keys, reports::Style& style) {
  style.page_width = keys.mm("page.width_mm", 90, 1000);
  style.page_height = keys.mm("page.height_mm", 90, 1000);
  style.left = keys.mm("page.left_mm", 0, 100);
  style.right = keys.mm("page.right_mm", 0, 100);
  style.top = keys.mm("page.top_mm", 0, 100);
  style.bottom = keys.mm("page.bottom_mm", 5, 100);
  style.title = keys.number("font.title_pt", 4, 60);
  style.heading = keys.number("font.heading_pt", 4, 40);
  style.subheading = keys.number("font.subheading_pt", 4, 40);
  style.body = keys.number("font.body_pt", 4, 30);
  style.small = keys.number("font.small_pt", 4, 30);
  style.plot_height = keys.mm("plot.height_mm", 25, 200);
  style.see_through = keys.number("plot.band_opacity", 0, 1);
  style.text = keys.colour("colour.text");
  style.muted = keys.colour("colour.muted");
  style.rule = keys.colour("colour.rule");
  style.shade = keys.colour("colour.shade");
  style.accent = keys.colour("colour.accent");
  style.good = keys.colour("colour.good");
  style.attention = keys.colour("colour.attention");
  style.failed = keys.colour("colour.failed");
  style.plus = keys.colour("colour.plus");
  style.minus = keys.colour("colour.minus");
}

Expected<std::string_view> font_file(const Templates& templates, const std::string& name) {
  const auto it = templates.files.find(name);
  if (it == templates.files.end())
    return fail(Error{"the font \"" + name + "\" is not there", "templates/" + name});
  return std::string_view(it->second);
}

}  // namespace

Expected<Look> read_look(const Templates& templates, const std::string& name, const Names& blocks,
                         const Names& measurement) {
  const std::string file = "templates/" + name + ".toml";
  const auto it = templates.tables.find(name);
  if (it == templates.tables.end())
    return fail(Error{"there is no template of the name \"" + name + "\"", file});
  Keys keys(it->second, file);
  Look look;
  look.blocks = keys.names("blocks", blocks);
  look.measurement = keys.names("measurement", measurement);
  look.plots = keys.names(
      "plots", {"runs", "iso", "vdi", "reversal", "diagonals", "volume", "circle", "series"});
  look.summary = keys.any_names("summary");
  look.plots_per_row = static_cast<int>(keys.number("plots_per_row", 1, 3));
  look.regular = keys.text("font.regular");
  look.bold = keys.text("font.bold");
  look.wide = keys.text_if_given("font.wide");
  look.profile = keys.text_if_given("colour.profile");
  look.verification = keys.address_if_given("verification.address");
  look.logo = keys.text_if_given("logo.file");
  look.mark = keys.text_if_given("logo.mark");
  if (!look.logo.empty() || !look.mark.empty()) look.logo_height = keys.mm("logo.height_mm", 3, 80);
  read_style(keys, look.style);
  if (auto done = keys.done(); !done) return fail(done.error());
  return look;
}

Expected<std::shared_ptr<const reports::Fonts>> fonts_of(const Templates& templates,
                                                         const Look& look) {
  NONIO_TRY(const auto regular, font_file(templates, look.regular));
  NONIO_TRY(const auto bold, font_file(templates, look.bold));
  if (look.wide.empty()) return reports::shared_fonts({regular, look.regular}, {bold, look.bold});
  NONIO_TRY(const auto wide, font_file(templates, look.wide));
  return reports::shared_fonts({regular, look.regular}, {bold, look.bold}, {wide, look.wide});
}

}  // namespace nonio::pages
