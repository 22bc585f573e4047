// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cstdio>
#include <set>

#include "nonio/pdf/bytes.h"
#include "nonio/pdf/signature_field.h"
#include "nonio/pdf/writer.h"

namespace nonio::pdf {

namespace {

/// "text/csv" becomes /text#2Fcsv.
std::string name_of(std::string_view text) {
  std::string out = "/";
  for (const char c : text) {
    const bool kept = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                      c == '-' || c == '.';
    out += kept ? std::string(1, c) : "#" + hexadecimal({&c, 1}).substr(1, 2);
  }
  return out;
}

template <class... Numbers>
std::string formatted(const char* format, Numbers... numbers) {
  std::array<char, 64> text{};
  const int n = std::snprintf(text.data(), text.size(), format, numbers...);
  return {text.data(), static_cast<std::size_t>(n)};
}

class Reservation {
 public:
  Reservation(const File& file, Time time, std::size_t room)
      : file_(file), time_(time), room_(room), offsets_(file.objects.size()) {}

  Expected<std::string> make(const std::vector<Attachment>& attachments) {
    if (auto fit = check(); !fit) return fail(fit.error());
    const std::size_t page = page_of_signature(), signature = offsets_.size(),
                      field = signature + 1, look = field + 1;
    const std::string frame = frame_of(page);
    offsets_.resize(frame.empty() ? look : look + 1);
    std::string names;
    for (const std::size_t i : in_order_of_names(attachments))
      if (auto added = attach(attachments[i], names); !added) return fail(added.error());

    out_.assign(file_.bytes.substr(0, file_.body));
    for (const std::size_t number : file_.order) copy(number, page, field, names);
    for (const auto& [number, text] : attached_) put(number, text);
    put_signature(signature);
    put(field, "<<\n/Type /Annot\n/Subtype /Widget\n/FT /Sig\n/T (Signature1)\n/F 132\n/Rect " +
                   (frame.empty() ? "[0 0 0 0]" : frame) + "\n" +
                   (frame.empty() ? "" : "/AP << /N " + reference(look) + " >>\n") + "/P " +
                   reference(page) + "\n/V " + reference(signature) + "\n>>");
    if (!frame.empty())  // The appearance is empty, because the page itself draws the frame.
      put(look, "<<\n/Type /XObject\n/Subtype /Form\n/BBox " + frame +
                    "\n/Length 0\n>>\nstream\n\nendstream");
    put_table();
    fill_range();
    return std::move(out_);
  }

 private:
  std::string frame_of(std::size_t page) const {
    const Value* frame = file_.objects[page].value.find(signature_key);
    if (frame == nullptr || !frame->is(Value::Kind::array) || frame->items.size() != 4) return {};
    std::string text = "[";
    for (const Value& number : frame->items) {
      if (!number.is(Value::Kind::integer)) return {};
      text += (text.size() > 1 ? " " : "") + std::to_string(number.integer);
    }
    return text + "]";
  }

  std::size_t page_of_signature() const {
    for (const std::size_t number : file_.order) {
      const Value* type = file_.objects[number].value.find("Type");
      if (type != nullptr && type->is_name("Page") && !frame_of(number).empty()) return number;
    }
    return file_.first_page();
  }

  Expected<void> check() const {
    const Value* catalog = file_.catalog();
    const std::size_t page = file_.first_page() == 0 ? 0 : page_of_signature();
    if (catalog == nullptr || page == 0) return fail("expected a PDF with pages");
    for (const char* key : {"AcroForm", "Names", "AF", "Perms"})
      if (catalog->find(key) != nullptr)
        return fail(std::string("the PDF has /") + key +
                    " already: expected neither form nor attachments");
    const Value* annotations = file_.objects[page].value.find("Annots");
    if (annotations != nullptr && !annotations->is(Value::Kind::array))
      return fail("the first page's /Annots is not a plain list");
    if (room_ < 1000 || room_ > max_room)
      return fail("expected 1000 to 32000 bytes for a signature");
    return {};
  }

  /// PDF requires sorted keys in a name tree.
  static std::vector<std::size_t> in_order_of_names(const std::vector<Attachment>& attachments) {
    std::vector<std::size_t> order(attachments.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return attachments[a].name < attachments[b].name;
    });
    return order;
  }

  Expected<void> attach(const Attachment& a, std::string& names) {
    const auto name = utf16(a.name), says = utf16(a.says);
    if (!name || !says || a.name.empty() || a.name.size() > 255)
      return fail("the attachment \"" + a.name + "\": expected a name and a description in UTF-8");
    if (!names_.insert(a.name).second) return fail("two attachments are called " + a.name);
    const std::string packed = deflated(a.bytes, 6);
    if (packed.empty()) return fail("no memory for the attachment " + a.name);
    const std::size_t stream = offsets_.size(), specification = stream + 1;
    offsets_.resize(specification + 1);
    attached_.emplace_back(
        stream, "<<\n/Type /EmbeddedFile\n/Subtype " + name_of(a.type) + "\n/Params << /Size " +
                    std::to_string(a.bytes.size()) + " /ModDate " + date_text(time_) +
                    " >>\n/Filter /FlateDecode\n/Length " + std::to_string(packed.size()) +
                    "\n>>\nstream\n" + packed + "\nendstream");
    attached_.emplace_back(specification,
                           "<<\n/Type /Filespec\n/F (" + plain_name(a.name) + ")\n/UF " +
                               hexadecimal(*name) + "\n/Desc " + hexadecimal(*says) +
                               "\n/AFRelationship " + name_of(a.relation) + "\n/EF << /F " +
                               reference(stream) + " /UF " + reference(stream) + " >>\n>>");
    names += hexadecimal(a.name) + " " + reference(specification) + "\n";
    files_ += reference(specification) + " ";
    return {};
  }

  void copy(std::size_t number, std::size_t page, std::size_t field, const std::string& names) {
    const Object& object = file_.objects[number];
    offsets_[number] = out_.size();
    const std::string_view text = file_.bytes.substr(object.begin, object.end - object.begin);
    std::size_t at = 0;
    std::string more;
    if (number == page) {
      const Value* annotations = object.value.find("Annots");
      at = annotations != nullptr ? annotations->end - 1 : object.value.end - 2;
      more = annotations != nullptr ? " " + reference(field)
                                    : "/Annots [ " + reference(field) + " ]\n";
    } else if (&object.value == file_.catalog()) {
      at = object.value.end - 2;
      more = "/AcroForm << /Fields [ " + reference(field) + " ] /SigFlags 3 >>\n";
      if (!names.empty())
        more +=
            "/Names << /EmbeddedFiles << /Names [\n" + names + "] >> >>\n/AF [ " + files_ + "]\n";
    }
    if (more.empty()) {
      out_ += text;
      return;
    }
    out_ += text.substr(0, at - object.begin);
    out_ += more;
    out_ += text.substr(at - object.begin);
  }

  void put(std::size_t number, const std::string& text) {
    offsets_[number] = out_.size();
    out_ += std::to_string(number) + " 0 obj\n" + text + "\nendobj\n";
  }

  void put_signature(std::size_t number) {
    const std::string head = "<<\n/Type /Sig\n/Filter /Adobe.PPKLite\n/SubFilter /" +
                             std::string(sub_filter) + "\n/M " + date_text(time_) + "\n/ByteRange ";
    const std::string range = "[0 0000000000 0000000000 0000000000]";
    range_ = out_.size() + std::to_string(number).size() + 7 + head.size();
    gap_ = range_ + range.size() + std::string_view("\n/Contents ").size();
    put(number, head + range + "\n/Contents <" + std::string(2 * room_, '0') + ">\n>>");
  }

  void put_table() {
    const std::size_t table = out_.size();
    out_ += "xref\n0 " + std::to_string(offsets_.size()) + "\n0000000000 65535 f\r\n";
    for (std::size_t i = 1; i < offsets_.size(); ++i)
      out_ += formatted("%010zu 00000 n\r\n", offsets_[i]);
    out_ += "trailer\n<<\n";
    for (std::size_t i = 0; i < file_.trailer.keys.size(); ++i) {
      const Value& value = file_.trailer.items[i];
      if (const std::string& key = file_.trailer.keys[i]; key != "Size" && key != "ID")
        out_ += name_of(key) + " " +
                std::string(file_.bytes.substr(value.begin, value.end - value.begin)) + "\n";
    }
    out_ += "/Size " + std::to_string(offsets_.size()) + "\n";
    // The identifier is computed from the input, not from the time, so that equal input gives equal
    // bytes.
    const std::string id = hexadecimal(sha256(file_.bytes).substr(0, 16));
    out_ += "/ID [ " + id + " " + id + " ]\n>>\nstartxref\n" + std::to_string(table) + "\n%%EOF\n";
  }

  void fill_range() {
    const std::size_t after = gap_ + 2 * room_ + 2;
    out_.replace(range_, 36,
                 formatted("[0 %010zu %010zu %010zu]", gap_, after, out_.size() - after));
  }

  const File& file_;
  const Time time_;
  const std::size_t room_;
  std::vector<std::size_t> offsets_;
  std::vector<std::pair<std::size_t, std::string>> attached_;
  std::string files_;
  std::set<std::string> names_;
  std::string out_;
  std::size_t range_ = 0, gap_ = 0;
};

}  // namespace

Expected<std::string> reserve(std::string_view bytes, const std::vector<Attachment>& attachments,
                              Time time, std::size_t room) {
  const auto file = parse(bytes);
  if (!file)
    return fail("cannot be signed, since it is no PDF as Nonio writes it: " + file.error().message);
  std::size_t total = bytes.size();
  for (const Attachment& a : attachments) total += a.bytes.size();
  if (total > max_file) return fail("is with its attachments larger than 100 MB");
  return Reservation(*file, time, room).make(attachments);
}

}  // namespace nonio::pdf
