// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/attachments.h"

#include "nonio/pdf/signature_field.h"

namespace nonio::pdf {

namespace {

std::string text_at(const File& file, const Value* dictionary, const char* key) {
  const Value* value = file.find(dictionary, key);
  return value == nullptr ? "" : value->text;
}

/// The two names of an attachment must be equal, and so must its two references to the content;
/// otherwise two readers could show different names or files.
Expected<void> check_form(const File& file, const Value* specification, const std::string& key,
                          const std::string& name) {
  const Value* files = file.find(specification, "EF");
  const Value* one = files == nullptr ? nullptr : files->find("F");
  const Value* other = files == nullptr ? nullptr : files->find("UF");
  if (key != name || text_at(file, specification, "F") != plain_name(name))
    return fail("the attachment " + quoted(name) + " has more than one name");
  if (one == nullptr || other == nullptr || !one->is(Value::Kind::reference) ||
      !other->is(Value::Kind::reference) || one->integer != other->integer ||
      files->keys.size() != 2)
    return fail("the attachment " + quoted(name) + " has more than one content");
  return {};
}

Expected<Attachment> attachment_of(const File& file, const std::string& key, const Value* reference,
                                   std::size_t& total) {
  const Value* specification = file.resolve(reference);
  const auto name = utf8(text_at(file, specification, "UF"));
  if (!name || name->empty()) return fail("an attachment without a name");
  if (auto sound = check_form(file, specification, key, *name); !sound) return fail(sound.error());
  const Object* stream = file.object(file.find(specification, "EF")->find("F"));
  const Value* parameters = stream == nullptr ? nullptr : file.find(&stream->value, "Params");
  const Value* size = file.find(parameters, "Size");
  if (stream == nullptr || size == nullptr || !size->is(Value::Kind::integer) || size->integer < 0)
    return fail("the attachment " + quoted(*name) + " has no size");
  const auto bytes = static_cast<std::size_t>(size->integer);
  if (bytes > max_file - total) return fail("attachments of more than 100 MB");
  total += bytes;
  auto unpacked = content(file, *stream, bytes);
  if (!unpacked) return fail("the attachment " + quoted(*name) + " " + unpacked.error().message);
  return Attachment{*name, std::move(*unpacked), text_at(file, &stream->value, "Subtype"),
                    text_at(file, specification, "AFRelationship"),
                    utf8(text_at(file, specification, "Desc")).value_or("")};
}

/// If this differs from the number of listed files, some files are hidden.
std::size_t embedded_in(const File& file) {
  std::size_t n = 0;
  for (const Object& object : file.objects) {
    const Value* type = object.value.find("Type");
    if (type != nullptr && type->is_name("EmbeddedFile")) ++n;
  }
  return n;
}

bool same_references(const Value* one, const Value& names) {
  if (one == nullptr || !one->is(Value::Kind::array) || 2 * one->items.size() != names.items.size())
    return false;
  for (std::size_t i = 0; i < one->items.size(); ++i)
    if (!one->items[i].is(Value::Kind::reference) ||
        one->items[i].integer != names.items[2 * i + 1].integer)
      return false;
  return true;
}

}  // namespace

Expected<std::vector<Attachment>> attachments_of(const File& file) {
  std::vector<Attachment> out;
  const Value* names = file.find(file.find(file.catalog(), "Names"), "EmbeddedFiles");
  if (names == nullptr) {
    if (embedded_in(file) != 0) return fail("holds files that it does not list");
    return out;
  }
  const Value* list = file.find(names, "Names");
  if (list == nullptr || !list->is(Value::Kind::array) || list->items.size() % 2 != 0)
    return fail("a list of attachments that is none");
  if (embedded_in(file) != list->items.size() / 2 ||
      !same_references(file.find(file.catalog(), "AF"), *list))
    return fail("holds other files than it lists");
  std::size_t total = 0;
  for (std::size_t i = 0; i < list->items.size(); i += 2) {
    NONIO_TRY(auto one, attachment_of(file, list->items[i].text, &list->items[i + 1], total));
    if (!out.empty() && out.back().name >= one.name)
      return fail("the attachment " + quoted(one.name) +
                  " is present twice, or its name is misplaced");
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace nonio::pdf
