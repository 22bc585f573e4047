// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/signature_field.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace nonio::pdf {

Expected<const Value*> find_signature(const File& file) {
  const Value* form = file.find(file.catalog(), "AcroForm");
  const Value* fields = file.find(form, "Fields");
  if (fields == nullptr || !fields->is(Value::Kind::array)) return fail("has no signature");
  if (fields->items.size() != 1)
    return fail("has " + std::to_string(fields->items.size()) + " form fields, expected one");
  const Value* field = file.resolve(&fields->items.front());
  const Value* type = file.find(field, "FT");
  if (type == nullptr || !type->is_name("Sig") || field->find("Kids") != nullptr)
    return fail("has a form field that is not a signature");
  const Value* value = file.find(field, "V");
  if (value == nullptr || !value->is(Value::Kind::dictionary)) return fail("is not signed");
  std::size_t dictionaries = 0;
  for (const Object& object : file.objects)
    if (object.value.find("ByteRange") != nullptr) ++dictionaries;
  if (dictionaries != 1)
    return fail("has " + std::to_string(dictionaries) + " signature dictionaries, expected one");
  const Value* filter = value->find("SubFilter");
  if (filter == nullptr || !filter->is_name(sub_filter))
    return fail("has a signature of another kind than " + std::string(sub_filter));
  return value;
}

namespace {

bool is_lower_hexadecimal(std::string_view text) {
  return text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace

Expected<PdfSignature> signature_at_end(std::string_view bytes) {
  // Largest distance of the signature from the end of the file, bytes: its field and the table of
  // at most 100,000 objects follow.
  constexpr std::size_t farthest = 3'000'000;
  constexpr std::string_view range = "\n/ByteRange [0 ", then = "]\n/Contents ";
  constexpr std::size_t digits = 10, time_size = 19;
  const std::size_t from = bytes.size() - std::min(bytes.size(), farthest);
  const std::size_t found = bytes.substr(from).rfind(range);
  if (found == std::string_view::npos || from + found < time_size)
    return fail(
        "has no signature where Nonio writes one: it was changed, or saved again by another "
        "program, which breaks the signature; request the file as it was issued");
  std::size_t at = from + found + range.size();
  std::array<std::size_t, 3> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i, at += digits + 1) {
    const std::string_view text = bytes.substr(std::min(at, bytes.size()), digits);
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), numbers.at(i));
    if (text.size() != digits || parsed.ptr != text.data() + digits ||
        !bytes.substr(at + digits).starts_with(i < 2 ? " " : then))
      return fail("/ByteRange: expected four numbers");
  }
  PdfSignature signature;
  signature.gap = at - 1 + then.size();
  const std::size_t after = numbers[1];
  if (numbers[0] != signature.gap || after <= signature.gap + 2 || after > bytes.size() ||
      numbers[2] != bytes.size() - after)
    return fail("the signed range is not the whole file but for the signature itself");
  if (after - signature.gap > 2 * max_room + 2)
    return fail("/Contents: longer than any signature of Nonio");
  signature.contents = bytes.substr(signature.gap + 1, after - signature.gap - 2);
  if (bytes[signature.gap] != '<' || bytes[after - 1] != '>' ||
      signature.contents.size() % 2 != 0 || !is_lower_hexadecimal(signature.contents))
    return fail("/Contents: expected digits and small letters a to f");
  signature.before = bytes.substr(0, signature.gap);
  signature.after = bytes.substr(after);
  NONIO_TRY(const auto time, time_in(bytes.substr(from + found - time_size, time_size)));
  signature.time = time;
  return signature;
}

Expected<Time> stated_time(std::string_view bytes) {
  NONIO_TRY(const auto signature, signature_at_end(bytes));
  return signature.time;
}

Expected<PdfSignature> signature_of(const File& file, const Value& dictionary) {
  const Value* range = dictionary.find("ByteRange");
  const Value* contents = dictionary.find("Contents");
  if (range == nullptr || !range->is(Value::Kind::array) || range->items.size() != 4 ||
      !std::all_of(range->items.begin(), range->items.end(),
                   [](const Value& v) { return v.is(Value::Kind::integer) && v.integer >= 0; }))
    return fail("/ByteRange: expected four numbers");
  if (contents == nullptr || !contents->is(Value::Kind::string) || !contents->hexadecimal)
    return fail("/Contents: expected hexadecimal digits");
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(range->items[i].integer); };
  if (at(0) != 0 || at(1) != contents->begin || at(2) != contents->end ||
      at(2) > file.bytes.size() || at(3) != file.bytes.size() - at(2))
    return fail("the signed range is not the whole file but for the signature itself");
  PdfSignature signature;
  signature.dictionary = &dictionary;
  signature.before = file.bytes.substr(0, contents->begin);
  signature.after = file.bytes.substr(contents->end);
  signature.gap = contents->begin;
  signature.contents = file.bytes.substr(contents->begin + 1, contents->end - contents->begin - 2);
  // Upper-case digits are rejected, because they state the same signature in different bytes.
  if (!is_lower_hexadecimal(signature.contents))
    return fail("/Contents: expected digits and small letters a to f");
  const Value* time = dictionary.find("M");
  const auto stated =
      time_in(time == nullptr ? "" : file.bytes.substr(time->begin, time->end - time->begin));
  if (!stated) return fail(stated.error());
  signature.time = *stated;
  return signature;
}

}  // namespace nonio::pdf
