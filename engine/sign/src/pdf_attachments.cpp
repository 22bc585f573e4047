// SPDX-License-Identifier: Apache-2.0
#include "pdf_signature.h"
#include "verify_parts.h"

namespace nonio::sign {

using pdf::File;
using pdf::Value;

namespace {

/// UTF-16 with a byte-order mark as UTF-8; an error for anything else.
Expected<std::string> utf8(std::string_view text) {
  if (!text.starts_with("\xFE\xFF") || text.size() % 2 != 0) return fail("wanted text in UTF-16");
  const auto unit = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]) << 8 |
                                      static_cast<unsigned char>(text[i + 1]));
  };
  std::string out;
  for (std::size_t i = 2; i < text.size(); i += 2) {
    std::uint32_t c = unit(i);
    if (c >= 0xD800 && c < 0xDC00 && i + 3 < text.size() && (unit(i + 2) & 0xFC00U) == 0xDC00) {
      i += 2;
      c = 0x10000 + ((c - 0xD800) << 10) + (unit(i) - 0xDC00);
    }
    if (c < 0x20 || (c >= 0xD800 && c < 0xE000)) return fail("wanted text in UTF-16");
    const int more = c < 0x80 ? 0 : c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
    constexpr unsigned char lead[] = {0, 0xC0, 0xE0, 0xF0};
    out += static_cast<char>(lead[more] | c >> (6 * more));
    for (int k = more - 1; k >= 0; --k) out += static_cast<char>(0x80 | ((c >> (6 * k)) & 0x3F));
  }
  return out;
}

std::string text_at(const File& file, const Value* dictionary, const char* key) {
  const Value* value = file.find(dictionary, key);
  return value == nullptr ? "" : value->text;
}

Expected<Attachment> attachment_of(const File& file, const Value* reference, std::size_t& total) {
  const Value* specification = file.resolve(reference);
  const Value* files = file.find(specification, "EF");
  const pdf::Object* stream = file.object(files == nullptr ? nullptr : files->find("F"));
  const Value* parameters = stream == nullptr ? nullptr : file.find(&stream->value, "Params");
  const Value* size = file.find(parameters, "Size");
  const auto name = utf8(text_at(file, specification, "UF"));
  if (stream == nullptr || size == nullptr || !size->is(Value::Kind::integer) ||
      size->integer < 0 || !name || name->empty())
    return fail("an attachment without name or size");
  const auto bytes = static_cast<std::size_t>(size->integer);
  if (bytes > max_file - total) return fail("attachments of more than 500 MB");
  total += bytes;
  auto content = pdf::content(file, *stream, bytes);
  if (!content) return fail("the attachment " + *name + " " + content.error().message);
  return Attachment{*name, std::move(*content), text_at(file, &stream->value, "Subtype"),
                    text_at(file, specification, "AFRelationship"),
                    utf8(text_at(file, specification, "Desc")).value_or("")};
}

}  // namespace

Expected<std::vector<Attachment>> attachments_of(const File& file) {
  std::vector<Attachment> out;
  const Value* names = file.find(file.find(file.catalog(), "Names"), "EmbeddedFiles");
  if (names == nullptr) return out;
  const Value* list = file.find(names, "Names");
  if (list == nullptr || !list->is(Value::Kind::array) || list->items.size() % 2 != 0)
    return fail("a list of attachments that is none");
  std::size_t total = 0;
  for (std::size_t i = 1; i < list->items.size(); i += 2) {
    auto one = attachment_of(file, &list->items[i], total);
    if (!one) return fail(one.error());
    out.push_back(std::move(*one));
  }
  return out;
}

}  // namespace nonio::sign
