// SPDX-License-Identifier: Apache-2.0
#include "pdf_signature.h"

#include <algorithm>

namespace nonio::sign {

using pdf::File;
using pdf::Value;

Expected<const Value*> find_signature(const File& file) {
  const Value* form = file.find(file.catalog(), "AcroForm");
  const Value* fields = file.find(form, "Fields");
  if (fields == nullptr || !fields->is(Value::Kind::array)) return fail("has no signature");
  if (fields->items.size() != 1)
    return fail("has " + std::to_string(fields->items.size()) + " form fields, wanted one");
  const Value* field = file.resolve(&fields->items.front());
  const Value* type = file.find(field, "FT");
  if (type == nullptr || !type->is_name("Sig") || field->find("Kids") != nullptr)
    return fail("has a form field that is no signature");
  const Value* value = file.find(field, "V");
  if (value == nullptr || !value->is(Value::Kind::dictionary)) return fail("is not signed");
  std::size_t dictionaries = 0;
  for (const pdf::Object& object : file.objects)
    if (object.value.find("ByteRange") != nullptr) ++dictionaries;
  if (dictionaries != 1)
    return fail("has " + std::to_string(dictionaries) + " signature dictionaries, wanted one");
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

Expected<PdfSignature> signature_of(const File& file, const Value& dictionary) {
  const Value* range = dictionary.find("ByteRange");
  const Value* contents = dictionary.find("Contents");
  if (range == nullptr || !range->is(Value::Kind::array) || range->items.size() != 4 ||
      !std::all_of(range->items.begin(), range->items.end(),
                   [](const Value& v) { return v.is(Value::Kind::integer) && v.integer >= 0; }))
    return fail("/ByteRange: wanted four numbers");
  if (contents == nullptr || !contents->is(Value::Kind::string) || !contents->hexadecimal)
    return fail("/Contents: wanted hexadecimal digits");
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(range->items[i].integer); };
  if (at(0) != 0 || at(1) != contents->begin || at(2) != contents->end ||
      at(2) > file.bytes.size() || at(3) != file.bytes.size() - at(2))
    return fail("the signed range is not the whole file but for the signature itself");
  PdfSignature signature;
  signature.dictionary = &dictionary;
  signature.before = file.bytes.substr(0, contents->begin);
  signature.behind = file.bytes.substr(contents->end);
  signature.gap = contents->begin;
  signature.contents = file.bytes.substr(contents->begin + 1, contents->end - contents->begin - 2);
  // Upper case would say the same in other bytes: a file has one form.
  if (!is_lower_hexadecimal(signature.contents))
    return fail("/Contents: wanted digits and small letters a to f");
  if (const Value* time = dictionary.find("M")) signature.time = time->text;
  return signature;
}

}  // namespace nonio::sign
