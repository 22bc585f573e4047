// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "nonio/pdf/signature_field.h"

namespace nonio::pdf {

namespace {

/// Streams are compared uncompressed, because another version of the library may have compressed
/// them.
class Comparison {
 public:
  Comparison(const File& a, const File& b, const Value* signature)
      : a_(a), b_(b), signature_(signature) {}

  Expected<void> run() const {
    if (a_.bytes.substr(0, a_.body) != b_.bytes.substr(0, b_.body)) return fail("its head differs");
    if (a_.objects.size() != b_.objects.size())
      return fail("it has " + std::to_string(a_.objects.size() - 1) + " objects, expected " +
                  std::to_string(b_.objects.size() - 1));
    if (a_.order != b_.order) return fail("its objects are in another order");
    if (!same_dictionary(a_.trailer, b_.trailer, {"ID"})) return fail("its trailer differs");
    for (std::size_t i = 1; i < a_.objects.size(); ++i)
      if (auto same = compare(i); !same) return same;
    return {};
  }

 private:
  Expected<void> compare(std::size_t number) const {
    const Object &a = a_.objects[number], &b = b_.objects[number];
    const bool is_signature = &b.value == signature_;
    const bool same_head = is_signature
                               ? same_dictionary(a.value, b.value, {"ByteRange", "Contents"})
                           : b.has_stream ? same_dictionary(a.value, b.value, {"Length"})
                                          : same(a.value, b.value);
    if (a.has_stream != b.has_stream || !same_head) return differs(number);
    if (!b.has_stream || a.stream == b.stream) return {};
    const auto one = content_up_to(a_, a, max_file), other = content_up_to(b_, b, max_file);
    if (!one || !other || *one != *other) return differs(number);
    return {};
  }

  tl::unexpected<Error> differs(std::size_t number) const {
    const Value* type = b_.objects[number].value.find("Type");
    const std::string kind =
        type != nullptr && type->is(Value::Kind::name) ? " (/" + type->text + ")" : "";
    return fail("its object " + std::to_string(number) + kind + " differs");
  }

  static std::string_view text(const File& file, const Value& v) {
    return file.bytes.substr(v.begin, v.end - v.begin);
  }

  bool same(const Value& a, const Value& b) const {
    if (a.kind != b.kind) return false;
    if (a.is(Value::Kind::dictionary)) return same_dictionary(a, b, {});
    if (!a.is(Value::Kind::array)) return text(a_, a) == text(b_, b);
    return std::equal(a.items.begin(), a.items.end(), b.items.begin(), b.items.end(),
                      [&](const Value& x, const Value& y) { return same(x, y); });
  }

  bool same_dictionary(const Value& a, const Value& b,
                       std::initializer_list<std::string_view> but) const {
    if (!a.is(Value::Kind::dictionary) || !b.is(Value::Kind::dictionary) || a.keys != b.keys)
      return false;
    for (std::size_t i = 0; i < a.keys.size(); ++i)
      if (std::find(but.begin(), but.end(), a.keys[i]) == but.end() &&
          !same(a.items[i], b.items[i]))
        return false;
    return true;
  }

  const File &a_, &b_;
  const Value* signature_;
};

}  // namespace

Expected<void> same_pdf(std::string_view signed_pdf, std::string_view reserved) {
  const auto a = parse(signed_pdf), b = parse(reserved);
  if (!a || !b) return fail(a ? b.error() : a.error());
  NONIO_TRY(const auto signature, find_signature(*b));
  return Comparison(*a, *b, signature).run();
}

}  // namespace nonio::pdf
