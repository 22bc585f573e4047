// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/reader.h"

#include <libdeflate.h>

#include <algorithm>
#include <charconv>
#include <memory>

#include "nonio/pdf/attachments.h"
#include "nonio/pdf/lexer.h"

namespace nonio::pdf {

const Value* Value::find(std::string_view key) const {
  if (kind != Kind::dictionary) return nullptr;
  const auto at = std::find(keys.begin(), keys.end(), key);
  return at == keys.end() ? nullptr : &items[static_cast<std::size_t>(at - keys.begin())];
}

const Object* File::object(const Value* reference) const {
  if (reference == nullptr || !reference->is(Value::Kind::reference)) return nullptr;
  const auto number = static_cast<std::size_t>(reference->integer);
  return number > 0 && number < objects.size() ? &objects[number] : nullptr;
}

const Value* File::resolve(const Value* value) const {
  if (value == nullptr || !value->is(Value::Kind::reference)) return value;
  const Object* target = object(value);
  // A reference to a reference is rejected, because no program writes one.
  if (target == nullptr || target->value.is(Value::Kind::reference)) return nullptr;
  return &target->value;
}

const Value* File::find(const Value* dictionary, std::string_view key) const {
  return dictionary == nullptr ? nullptr : resolve(dictionary->find(key));
}

std::size_t File::first_page() const {
  const Value* pages = catalog();
  const Value* reference = pages == nullptr ? nullptr : pages->find("Pages");
  for (int depth = 0; depth < 32; ++depth) {
    const Value* node = resolve(reference);
    const Value* type = find(node, "Type");
    if (type == nullptr || !reference->is(Value::Kind::reference)) return 0;
    if (type->is_name("Page")) return static_cast<std::size_t>(reference->integer);
    const Value* kids = find(node, "Kids");
    if (kids == nullptr || !kids->is(Value::Kind::array) || kids->items.empty()) return 0;
    reference = &kids->items.front();
  }
  return 0;
}

namespace {

class FileReader {
 public:
  explicit FileReader(std::string_view bytes) { file_.bytes = bytes; }

  Expected<File> read() {
    if (auto done = read_head(); !done) return fail(done.error());
    if (auto done = read_tail(); !done) return fail(done.error());
    if (auto done = read_table(); !done) return fail(done.error());
    if (auto done = read_objects(); !done) return fail(done.error());
    return std::move(file_);
  }

 private:
  static tl::unexpected<Error> refuse(std::size_t at, const std::string& what) {
    return fail("byte " + std::to_string(at) + ": " + what);
  }

  Expected<void> read_head() {
    const std::string_view b = file_.bytes;
    if (!b.starts_with("%PDF-1.") || b.size() < 64 || b[7] < '3' || b[7] > '7' || b[8] != '\n')
      return fail("is not a PDF of version 1.3 to 1.7");
    std::size_t at = 9;
    if (b[at] == '%') {  // A comment of four bytes above 127 marks a binary file.
      if (b[at + 5] != '\n') return refuse(at, "expected a comment of four bytes");
      for (std::size_t i = at + 1; i < at + 5; ++i)
        if (static_cast<unsigned char>(b[i]) < 0x80) return refuse(i, "expected a byte above 127");
      at += 6;
    }
    file_.body = at;
    return {};
  }

  Expected<void> read_tail() {
    const std::string_view b = file_.bytes;
    constexpr std::string_view end = "\n%%EOF\n", word = "startxref\n";
    if (!b.ends_with(end)) return fail("does not end with %%EOF and a new line");
    const std::size_t number_end = b.size() - end.size();
    std::size_t number = number_end;
    while (number > 0 && b[number - 1] >= '0' && b[number - 1] <= '9') --number;
    if (number < word.size() || b.substr(number - word.size(), word.size()) != word)
      return refuse(number, "expected startxref and the place of the table");
    tail_ = number - word.size();
    const auto parsed = std::from_chars(b.data() + number, b.data() + number_end, file_.xref);
    if (parsed.ec != std::errc() || parsed.ptr != b.data() + number_end || file_.xref >= tail_ ||
        file_.xref < file_.body)
      return refuse(number, "the position of the table is outside the file");
    return {};
  }

  Expected<void> read_table() {
    Lexer in(file_.bytes.substr(0, tail_), file_.xref);
    std::size_t count = 0;
    if (!in.take("xref\n0 ") || !in.take_number(count, 10) || !in.take("\n") || count < 2 ||
        count > 100000)
      return refuse(in.at(), "expected one cross-reference table that begins with object 0");
    offsets_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const char* kind = i == 0 ? " 65535 f" : " 00000 n";
      if (!in.take_digits(offsets_[i], 10) || !in.take(kind) ||
          !(in.take("\r\n") || in.take(" \n")))
        return refuse(in.at(), "expected the entry of object " + std::to_string(i));
    }
    if (offsets_.front() != 0) return refuse(in.at(), "expected no free object but the first");
    if (!in.take("trailer\n")) return refuse(in.at(), "expected the trailer");
    NONIO_TRY(auto trailer, in.value());
    if (!trailer.is(Value::Kind::dictionary)) return refuse(in.at(), "expected a dictionary");
    in.skip_space();
    if (in.at() != tail_) return refuse(in.at(), "expected startxref");
    for (const char* key : {"Prev", "XRefStm", "Encrypt"})
      if (trailer.find(key) != nullptr)
        return fail(std::string("the trailer has /") + key +
                    ": expected one revision, not encrypted");
    const Value* size = trailer.find("Size");
    if (size == nullptr || !size->is(Value::Kind::integer) ||
        size->integer != static_cast<std::int64_t>(count))
      return fail("the trailer's /Size is not the number of objects");
    file_.trailer = std::move(trailer);
    return {};
  }

  Expected<void> read_objects() {
    file_.objects.resize(offsets_.size());
    for (std::size_t i = 1; i < offsets_.size(); ++i) file_.order.push_back(i);
    std::sort(file_.order.begin(), file_.order.end(),
              [&](std::size_t a, std::size_t b) { return offsets_[a] < offsets_[b]; });
    std::size_t at = file_.body;
    for (const std::size_t number : file_.order) {
      if (offsets_[number] != at)
        return refuse(at, "expected object " + std::to_string(number) +
                              " here: bytes that belong to nothing, or to two things");
      if (auto done = read_object(number, at); !done) return done;
      at = file_.objects[number].end;
    }
    if (at != file_.xref) return refuse(at, "bytes that belong to nothing before the table");
    return {};
  }

  Expected<void> read_object(std::size_t number, std::size_t at) {
    Lexer in(file_.bytes.substr(0, file_.xref), at, budget_);
    Object& object = file_.objects[number];
    object.begin = at;
    std::size_t found = 0;
    if (!in.take_number(found, 10) || found != number || !in.take(" 0 obj"))
      return refuse(at, "expected object " + std::to_string(number));
    NONIO_TRY(auto value, in.value());
    object.value = std::move(value);
    in.skip_space();
    if (in.take("stream"))
      if (auto done = read_stream(in, object); !done) return done;
    in.skip_space();
    if (!in.take("endobj"))
      return refuse(in.at(), "expected the end of object " + std::to_string(number));
    in.skip_space();
    object.end = in.at();
    return {};
  }

  Expected<void> read_stream(Lexer& in, Object& object) {
    if (!in.take("\r\n") && !in.take("\n")) return refuse(in.at(), "expected a line's end");
    const auto length = length_of(object.value.find("Length"));
    if (!length) return refuse(in.at(), "expected the length of a stream");
    if (*length > file_.xref - in.at()) return refuse(in.at(), "a stream longer than the file");
    object.has_stream = true;
    object.stream = file_.bytes.substr(in.at(), *length);
    in.skip(*length);
    if (!in.take("\r\n")) in.take("\n");
    if (!in.take("endstream")) return refuse(in.at(), "expected the end of a stream");
    return {};
  }

  std::optional<std::size_t> length_of(const Value* value) const {
    if (value == nullptr || value->integer < 0) return std::nullopt;
    if (value->is(Value::Kind::integer)) return static_cast<std::size_t>(value->integer);
    if (!value->is(Value::Kind::reference)) return std::nullopt;
    const auto number = static_cast<std::size_t>(value->integer);
    if (number == 0 || number >= offsets_.size() || offsets_[number] >= file_.xref)
      return std::nullopt;
    Lexer in(file_.bytes.substr(0, file_.xref), offsets_[number]);
    std::size_t found = 0, length = 0;
    if (!in.take_number(found, 10) || found != number || !in.take(" 0 obj")) return std::nullopt;
    in.skip_space();
    if (!in.take_number(length, 10)) return std::nullopt;
    in.skip_space();
    if (!in.take("endobj")) return std::nullopt;
    return length;
  }

  File file_;
  std::size_t tail_ = 0;
  std::size_t budget_ = 1000000;
  std::vector<std::size_t> offsets_;
};

}  // namespace

Expected<File> parse(std::string_view bytes) { return FileReader(bytes).read(); }

namespace {

/// `longer` means that the content has more bytes than the space for the result.
enum class Unpacked { well, badly, longer };

Unpacked unpack(std::string_view packed, std::string& into) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflate(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  std::size_t used = 0, made = 0;
  if (!inflate) return Unpacked::badly;
  const auto result = libdeflate_zlib_decompress_ex(inflate.get(), packed.data(), packed.size(),
                                                    into.data(), into.size(), &used, &made);
  if (result == LIBDEFLATE_INSUFFICIENT_SPACE) return Unpacked::longer;
  if (result != LIBDEFLATE_SUCCESS || used != packed.size()) return Unpacked::badly;
  into.resize(made);
  return Unpacked::well;
}

Expected<bool> is_packed(const File& file, const Object& object) {
  if (!object.has_stream) return fail("expected a stream");
  const Value* filter = file.find(&object.value, "Filter");
  if (filter == nullptr) return false;
  if (!filter->is_name("FlateDecode") || object.value.find("DecodeParms") != nullptr)
    return fail("is compressed in another way than FlateDecode");
  return true;
}

/// Largest accepted ratio of uncompressed to compressed size. Deflate cannot exceed 1032, so that a
/// stated size beyond this ratio is false.
constexpr std::size_t best_ratio = 1040;

}  // namespace

Expected<std::string> content(const File& file, const Object& object, std::size_t size) {
  NONIO_TRY(const auto packed, is_packed(file, object));
  if (!packed) {
    if (object.stream.size() != size) return fail("has not the size that it should have");
    return std::string(object.stream);
  }
  if (size / best_ratio > object.stream.size()) return fail("has not the size that it should have");
  std::string out(size, '\0');
  if (unpack(object.stream, out) != Unpacked::well || out.size() != size)
    return fail("cannot be uncompressed to the size that it should have");
  return out;
}

Expected<std::string> content_up_to(const File& file, const Object& object, std::size_t most) {
  NONIO_TRY(const auto packed, is_packed(file, object));
  if (!packed) {
    if (object.stream.size() > most) return fail("is too long");
    return std::string(object.stream);
  }
  const std::size_t limit = std::min(most, object.stream.size() * best_ratio);
  for (std::size_t size = std::min(limit, object.stream.size() * 8);;
       size = std::min(limit, size * 4)) {
    std::string out(size, '\0');
    const Unpacked done = unpack(object.stream, out);
    if (done == Unpacked::well) return out;
    if (done == Unpacked::badly || size == limit) return fail("cannot be uncompressed");
  }
}

namespace {

class Pages {
 public:
  explicit Pages(const File& file) : file_(file) {}

  Expected<std::vector<std::string>> read() {
    if (auto done = read_node(file_.find(file_.catalog(), "Pages"), 0); !done)
      return fail(done.error());
    return std::move(pages_);
  }

 private:
  static constexpr std::size_t most_nodes = 20000, most_bytes = std::size_t{1} << 28;
  static constexpr int deepest = 32;

  Expected<void> read_node(const Value* node, int depth) {
    const Value* type = file_.find(node, "Type");
    if (type == nullptr || depth > deepest || ++nodes_ > most_nodes)
      return fail("the tree of pages cannot be read");
    if (type->is_name("Page")) return read_page(node->find("Contents"));
    const Value* kids = file_.find(node, "Kids");
    if (kids == nullptr || !kids->is(Value::Kind::array))
      return fail("the tree of pages has a gap");
    for (const Value& kid : kids->items)
      if (auto done = read_node(file_.resolve(&kid), depth + 1); !done) return done;
    return {};
  }

  Expected<void> read_page(const Value* contents) {
    pages_.emplace_back();
    const Value* list = file_.resolve(contents);
    if (list == nullptr || !list->is(Value::Kind::array)) return add(contents);
    for (const Value& part : list->items)
      if (auto done = add(&part); !done) return done;
    return {};
  }

  Expected<void> add(const Value* reference) {
    const Object* object = file_.object(reference);
    if (object == nullptr) return fail("a page has no content");
    auto bytes = content_up_to(file_, *object, most_bytes - used_);
    if (!bytes) return fail("the content of a page " + bytes.error().message);
    used_ += bytes->size();
    pages_.back() += *bytes + "\n";
    return {};
  }

  const File& file_;
  std::vector<std::string> pages_;
  std::size_t nodes_ = 0, used_ = 0;
};

}  // namespace

Expected<std::vector<std::string>> page_contents(std::string_view bytes) {
  NONIO_TRY(const auto file, parse(bytes));
  return Pages(file).read();
}

}  // namespace nonio::pdf
