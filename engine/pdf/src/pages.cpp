// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/attachments.h"

namespace nonio::pdf {

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
