// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

/// Reads a PDF at a security boundary. Untrusted bytes enter in two places: the file that a user
/// passes to `verify`, and the file that the process with the plugins sends to be signed
/// (`reserve`). A library that repairs damaged files also accepts files that two readers interpret
/// differently, for example with an update that hides an object, or with a second table. Therefore
/// this reader repairs nothing, and its cost is limited by the size of the file.
///
/// The reader accepts only what a certificate requires: one revision, one plain cross-reference
/// table, and whole objects one after the other with nothing between them.
namespace nonio::pdf {

struct Value {
  enum class Kind : std::uint8_t {
    null,
    boolean,
    integer,
    real,
    string,
    name,
    array,
    dictionary,
    reference
  };
  Kind kind = Kind::null;
  std::int64_t integer = 0;         ///< value of an integer, or object number of a reference
  std::string text{};               ///< decoded text of a string or name
  std::vector<Value> items{};       ///< elements of an array, or values that belong to `keys`
  std::vector<std::string> keys{};  ///< keys of a dictionary
  std::size_t begin = 0, end = 0;   ///< positions in the file: first byte, and byte after the last
  bool hexadecimal = false;         ///< whether a string has the hexadecimal form <...>

  bool is(Kind k) const { return kind == k; }
  bool is_name(std::string_view name) const { return kind == Kind::name && text == name; }
  /// Returns null if the key is missing or the value is not a dictionary.
  const Value* find(std::string_view key) const;
};

struct Object {
  Value value;
  /// Positions in the file: the first byte of the object number, and the byte after "endobj" and
  /// the following white space.
  std::size_t begin = 0, end = 0;
  bool has_stream = false;
  std::string_view stream{};  ///< bytes of the stream as in the file, not uncompressed
};

struct File {
  std::string_view bytes;
  std::vector<Object> objects;     ///< by object number; entry 0 is not used
  std::vector<std::size_t> order;  ///< object numbers in the order of the file
  Value trailer;
  /// Positions of the first object and of the cross-reference table, bytes.
  std::size_t body = 0, xref = 0;

  /// Returns the value or, for a reference, the value of the referenced object. Null if the object
  /// does not exist, or if it is a reference itself.
  const Value* resolve(const Value* value) const;
  const Value* find(const Value* dictionary, std::string_view key) const;
  /// Null if the value is not a reference, or if the object does not exist.
  const Object* object(const Value* reference) const;
  const Value* catalog() const { return find(&trailer, "Root"); }
  /// 0 if there is no page.
  std::size_t first_page() const;
};

/// `bytes` must outlive the result. Error: the PDF contains anything that this reader does not
/// accept.
Expected<File> parse(std::string_view bytes);

/// Returns the uncompressed content of a stream. Error: the object has no stream, the content does
/// not have exactly `size` bytes, or it is compressed by another method than /FlateDecode.
Expected<std::string> content(const File& file, const Object& object, std::size_t size);
/// As `content`, for a stream of unknown size. Error: the object has no stream, the content has
/// more than `most` bytes, or it cannot be uncompressed by /FlateDecode.
Expected<std::string> content_up_to(const File& file, const Object& object, std::size_t most);

}  // namespace nonio::pdf
