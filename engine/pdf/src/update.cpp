// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/update.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <optional>

#include "nonio/pdf/bytes.h"
#include "nonio/pdf/lexer.h"
#include "nonio/pdf/signature_field.h"

namespace nonio::pdf {

namespace {

constexpr std::string_view end_of_part = "\n%%EOF\n";

std::optional<std::size_t> number_in(std::string_view text) {
  std::size_t number = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    return std::nullopt;
  return number;
}

/// Position (/Prev) of the previous cross-reference table, as stated by the table of the part that
/// ends at `end`; std::nullopt if it states no such position.
std::optional<std::size_t> table_before(std::string_view bytes, std::size_t end) {
  constexpr std::size_t longest = 30000;  // bytes of the table and trailer of an update
  constexpr std::string_view word = "\nstartxref\n", previous = "\n/Prev ";
  const std::string_view part = bytes.substr(0, end);
  if (!part.ends_with(end_of_part)) return std::nullopt;
  const std::string_view tail = part.substr(end - std::min(end, std::size_t{60}));
  const std::size_t at = tail.rfind(word);
  if (at == std::string_view::npos) return std::nullopt;
  const auto table =
      number_in(tail.substr(at + word.size(), tail.size() - at - word.size() - end_of_part.size()));
  if (!table || *table >= end || end - *table > longest) return std::nullopt;
  const std::string_view trailer = part.substr(*table);
  const std::size_t found = trailer.find(previous);
  if (found == std::string_view::npos) return std::nullopt;
  const std::size_t digits = found + previous.size();
  const auto before = number_in(trailer.substr(digits, trailer.find('\n', digits) - digits));
  return before && *before < *table ? before : std::nullopt;
}

}  // namespace

std::vector<std::size_t> ends_of_parts(std::string_view bytes) {
  constexpr std::size_t longest_table = 3'000'000;
  std::vector<std::size_t> ends = {bytes.size()};
  while (ends.size() <= most_updates) {
    const auto before = table_before(bytes, ends.back());
    if (!before) break;
    const std::string_view table =
        bytes.substr(*before, std::min(longest_table, ends.back() - *before));
    const std::size_t found = table.find(end_of_part);
    if (found == std::string_view::npos) break;
    const std::size_t end = *before + found + end_of_part.size();
    if (end >= ends.back() || bytes.size() - end > most_update_bytes) break;
    ends.push_back(end);
  }
  std::reverse(ends.begin(), ends.end());
  return ends;
}

Updater::Updater(const File& file)
    : file_(&file),
      page_(file.first_page()),
      end_(file.bytes.size()),
      last_table_(file.xref),
      size_(file.objects.size()) {}

Expected<Updater> Updater::of(const File& file) {
  Updater out(file);
  const Value* root = file.trailer.find("Root");
  const Value* catalogue = file.catalog();
  if (catalogue == nullptr || !root->is(Value::Kind::reference) || out.page_ == 0)
    return fail("expected a PDF with pages");
  out.catalogue_ = static_cast<std::size_t>(root->integer);
  const Value* form = catalogue->find("AcroForm");
  const Value* fields = form == nullptr ? nullptr : form->find("Fields");
  const Value* annotations = file.objects[out.page_].value.find("Annots");
  const Value* id = file.trailer.find("ID");
  const auto is_list = [](const Value* v) { return v != nullptr && v->is(Value::Kind::array); };
  if (!is_list(fields) || (annotations != nullptr && !is_list(annotations)) || !is_list(id) ||
      id->items.empty() || catalogue->find("DSS") != nullptr || out.catalogue_ == out.page_)
    return fail("is not as Nonio signs a PDF");
  return out;
}

namespace {

std::string list_of(const char* key, const std::vector<std::size_t>& numbers) {
  if (numbers.empty()) return {};
  std::string out = std::string("/") + key + " [ ";
  for (const std::size_t n : numbers) out += reference(n) + " ";
  return out + "]\n";
}

std::string with(const File& file, const Object& object,
                 const std::vector<std::pair<std::size_t, std::string>>& more) {
  std::string out;
  std::size_t at = object.begin;
  for (const auto& [place, text] : more) {
    out += file.bytes.substr(at, place - at);
    out += text;
    at = place;
  }
  return out += file.bytes.substr(at, object.end - at);
}

std::string entry(std::size_t place) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%010zu 00000 n\r\n", place);
  return text.data();
}

std::string fields_text(const std::vector<std::size_t>& fields) {
  std::string out;
  for (const std::size_t n : fields) out += " " + reference(n);
  return out;
}

}  // namespace

std::string Updater::object_of_catalogue() const {
  const Object& object = file_->objects[catalogue_];
  const Value& value = object.value;
  std::vector<std::pair<std::size_t, std::string>> more = {
      {value.find("AcroForm")->find("Fields")->end - 1, fields_text(fields_)}};
  if (store_ != 0) more.emplace_back(value.end - 2, "/DSS " + reference(store_) + "\n");
  return with(*file_, object, more);
}

std::string Updater::object_of_page() const {
  const Object& object = file_->objects[page_];
  const Value* annotations = object.value.find("Annots");
  if (annotations != nullptr)
    return with(*file_, object, {{annotations->end - 1, fields_text(fields_)}});
  return with(*file_, object,
              {{object.value.end - 2, "/Annots [" + fields_text(fields_) + " ]\n"}});
}

std::string Updater::table(const std::vector<std::pair<std::size_t, std::size_t>>& places,
                           std::size_t at, const std::string& body) const {
  std::string out = "xref\n";
  for (std::size_t i = 0; i < places.size();) {
    std::size_t n = 1;
    while (i + n < places.size() && places[i + n].first == places[i].first + n) ++n;
    out += std::to_string(places[i].first) + " " + std::to_string(n) + "\n";
    for (const std::size_t last = i + n; i < last; ++i) out += entry(places[i].second);
  }
  out += "trailer\n<<\n";
  const Value& trailer = file_->trailer;
  const auto text_of_value = [&](const Value& v) {
    return std::string(file_->bytes.substr(v.begin, v.end - v.begin));
  };
  for (const char* key : {"Root", "Info"})
    if (const Value* value = trailer.find(key))
      out += std::string("/") + key + " " + text_of_value(*value) + "\n";
  return out + "/Size " + std::to_string(size_) + "\n/Prev " + std::to_string(last_table_) +
         "\n/ID [ " + text_of_value(trailer.find("ID")->items.front()) + " " +
         hexadecimal(sha256(body).substr(0, 16)) + " ]\n>>\nstartxref\n" + std::to_string(at) +
         "\n%%EOF\n";
}

class Updater::Objects {
 public:
  explicit Objects(Updater& to) : to_(to) {}

  void put(std::size_t number, const std::string& object) {
    places_.emplace_back(number, to_.end_ + bytes_.size());
    bytes_ += object;
  }
  std::size_t add(const std::string& object) {
    put(to_.size_, std::to_string(to_.size_) + " 0 obj\n" + object + "\nendobj\n");
    return to_.size_++;
  }
  void add_streams(const std::vector<std::string>& all, std::vector<std::size_t>& numbers) {
    for (const std::string& der : all)
      numbers.push_back(add("<<\n/Length " + std::to_string(der.size()) + "\n>>\nstream\n" + der +
                            "\nendstream"));
  }
  void add_stamp() {
    const std::string head =
                          "<<\n/Type /DocTimeStamp\n/Filter /Adobe.PPKLite\n/SubFilter "
                          "/ETSI.RFC3161\n/ByteRange ",
                      empty_range = "[0 0000000000 0000000000 0000000000]", then = "\n/Contents ";
    range_ = bytes_.size() + std::to_string(to_.size_).size() + 7 + head.size();
    gap_ = to_.end_ + range_ + empty_range.size() + then.size();
    const std::size_t signature =
        add(head + empty_range + then + "<" + std::string(2 * usual_room, '0') + ">\n>>");
    to_.fields_.push_back(to_.size_);
    add("<<\n/Type /Annot\n/Subtype /Widget\n/FT /Sig\n/T (TimeStamp" +
        std::to_string(to_.fields_.size()) + ")\n/F 132\n/Rect [0 0 0 0]\n/P " +
        reference(to_.page_) + "\n/V " + reference(signature) + "\n>>");
    put(to_.page_, to_.object_of_page());
  }
  void finish(Update& out) {
    std::sort(places_.begin(), places_.end());
    const std::size_t at = to_.end_ + bytes_.size();
    bytes_ += to_.table(places_, at, bytes_);
    if (out.has_stamp) {
      out.gap = gap_;
      out.after = gap_ + 2 * usual_room + 2;
      std::array<char, 64> text{};
      std::snprintf(text.data(), text.size(), "[0 %010zu %010zu %010zu]", out.gap, out.after,
                    to_.end_ + bytes_.size() - out.after);
      bytes_.replace(range_, 36, text.data());
    }
    to_.end_ += bytes_.size();
    to_.last_table_ = at;
    out.bytes = std::move(bytes_);
  }

 private:
  Updater& to_;
  std::vector<std::pair<std::size_t, std::size_t>> places_;
  std::string bytes_;
  std::size_t range_ = 0, gap_ = 0;
};

Expected<Update> Updater::write(const Store& more, bool has_stamp) {
  if (more.empty() && !has_stamp) return fail("there is nothing to add");
  Objects objects(*this);
  objects.add_streams(more.certificates, certificates_);
  objects.add_streams(more.answers, answers_);
  objects.add_streams(more.lists, lists_);
  if (certificates_.size() + answers_.size() + lists_.size() > most_stored)
    return fail("more than " + std::to_string(most_stored) + " certificates, lists and answers");
  if (!more.empty())
    store_ = objects.add("<<\n/Type /DSS\n" + list_of("Certs", certificates_) +
                         list_of("OCSPs", answers_) + list_of("CRLs", lists_) + ">>");
  if (has_stamp) objects.add_stamp();
  objects.put(catalogue_, object_of_catalogue());
  Update out;
  out.store = more;
  out.has_stamp = has_stamp;
  objects.finish(out);
  return out;
}

namespace {

std::size_t new_ones(const Value& store, const char* key, std::size_t first) {
  const Value* list = store.find(key);
  if (list == nullptr || !list->is(Value::Kind::array)) return 0;
  return static_cast<std::size_t>(
      std::count_if(list->items.begin(), list->items.end(), [&](const Value& v) {
        return v.is(Value::Kind::reference) && static_cast<std::size_t>(v.integer) >= first;
      }));
}

}  // namespace

/// Reads the new streams of an update and the object that lists them; sets `at` to the end of this
/// object. The result is empty if the update has no streams.
Expected<Store> Updater::read_store(std::string_view bytes, std::size_t& at) const {
  std::vector<std::string> streams;
  std::size_t number = size_;
  for (;; ++number) {
    Lexer in(bytes, at);
    std::size_t length = 0;
    if (!in.take(std::to_string(number) + " 0 obj\n<<\n/Length ") || !in.take_number(length, 8) ||
        !in.take("\n>>\nstream\n"))
      break;
    if (streams.size() >= most_stored || length > bytes.size() - in.at())
      return fail("a stream longer than the file, or too many");
    streams.emplace_back(bytes.substr(in.at(), length));
    in.skip(length);
    if (!in.take("\nendstream\nendobj\n")) return fail("a stream of another length than it states");
    at = in.at();
  }
  Store out;
  if (streams.empty()) return out;
  Lexer in(bytes, at);
  if (!in.take(std::to_string(number) + " 0 obj\n")) return fail("streams that belong to nothing");
  const auto store = in.value();
  if (!store || !in.take("\nendobj\n")) return fail("streams that belong to nothing");
  at = in.at();
  const std::size_t certificates = new_ones(*store, "Certs", size_),
                    answers = new_ones(*store, "OCSPs", size_),
                    lists = new_ones(*store, "CRLs", size_);
  if (certificates + answers + lists != streams.size())
    return fail("streams that belong to nothing");
  auto next = std::make_move_iterator(streams.begin());
  const auto take = [&](std::size_t n, std::vector<std::string>& to) {
    to.assign(next, next + static_cast<std::ptrdiff_t>(n));
    next += static_cast<std::ptrdiff_t>(n);
  };
  take(certificates, out.certificates);
  take(answers, out.answers);
  take(lists, out.lists);
  return out;
}

Expected<Update> Updater::read(std::string_view bytes, std::size_t end) {
  const auto strange = [&](const std::string& what) {
    return fail("the update from byte " + std::to_string(end_) + " on holds " + what);
  };
  const std::string_view part = bytes.substr(0, end);
  const std::size_t begin = end_;
  std::size_t at = begin;
  const auto store = read_store(part, at);
  if (!store) return strange(store.error().message);
  const std::string number =
      std::to_string(size_ + store->certificates.size() + store->answers.size() +
                     store->lists.size() + (store->empty() ? 0 : 1));
  const bool has_stamp = part.substr(at).starts_with(number + " 0 obj\n<<\n/Type /DocTimeStamp\n");
  constexpr const char* what =
      "something else than revocation data and a time stamp as Nonio writes them";
  if (store->empty() && !has_stamp) return strange(what);
  auto again = write(*store, has_stamp);
  if (!again) return strange(again.error().message);
  const std::string_view found = part.substr(begin), wanted = again->bytes;
  const std::size_t gap = has_stamp ? again->gap + 1 - begin : wanted.size(),
                    after = has_stamp ? again->after - 1 - begin : wanted.size();
  if (found.size() != wanted.size() || found.substr(0, gap) != wanted.substr(0, gap) ||
      found.substr(after) != wanted.substr(after))
    return strange(what);
  again->bytes = found;
  return again;
}

}  // namespace nonio::pdf
