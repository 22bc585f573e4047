// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

/// A security boundary. Untrusted bytes enter here in two places: the file that a user gives to
/// `verify`, and the file that the process with the plugins sends to be signed (`reserve`). A
/// library that repairs what it reads takes a file that two readers read differently: with an
/// update that hides an object, or a second table. So this reader is our own, repairs nothing, and
/// costs no more than the size of the file allows. Nothing else of Nonio reads a PDF.
///
/// PDF as narrowly as a certificate needs it: one revision, one plain cross-reference table, whole
/// objects one after the other with nothing between them. Whatever is more is refused, because what
/// a reader would have to guess, two readers may guess differently.
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
  std::int64_t integer = 0;         ///< of an integer; of a reference: the object's number
  std::string text{};               ///< of a string or name, decoded
  std::vector<Value> items{};       ///< of an array; of a dictionary: the values of `keys`
  std::vector<std::string> keys{};  ///< of a dictionary
  std::size_t begin = 0, end = 0;   ///< its position in the file
  bool hexadecimal = false;         ///< of a string: written as <...>

  bool is(Kind k) const { return kind == k; }
  bool is_name(std::string_view name) const { return kind == Kind::name && text == name; }
  const Value* find(std::string_view key) const;  ///< of a dictionary; null if it is missing
};

struct Object {
  Value value;
  std::size_t begin = 0, end = 0;  ///< from its number to the end of "endobj" and the line's end
  bool has_stream = false;
  std::string_view stream{};  ///< as in the file
};

struct File {
  std::string_view bytes;
  std::vector<Object> objects;     ///< by number; 0 is nothing
  std::vector<std::size_t> order;  ///< numbers as they follow in the file
  Value trailer;
  std::size_t body = 0, xref = 0;  ///< where the objects begin, and the table behind them

  /// What a value is after a reference was followed; null if there is none.
  const Value* resolve(const Value* value) const;
  const Value* find(const Value* dictionary, std::string_view key) const;
  /// The object that a reference names; null if it is no reference.
  const Object* object(const Value* reference) const;
  const Value* catalog() const { return find(&trailer, "Root"); }
  /// The number of the first page's object; 0 if there is none.
  std::size_t first_page() const;
};

/// `bytes` must outlive the file.
Expected<File> parse(std::string_view bytes);

/// The content of a stream, uncompressed; `size` is what it must be. Only /FlateDecode or none.
Expected<std::string> content(const File& file, const Object& object, std::size_t size);
/// Of a stream whose size is not known; `most` bytes at the most.
Expected<std::string> content_up_to(const File& file, const Object& object, std::size_t most);

}  // namespace nonio::pdf
