// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/last_run.h"

#include <simdjson.h>

#include "platform/storage/files.h"

namespace nonio::assessment {

namespace {

using simdjson::dom::element;
using simdjson::dom::object;

std::string text_of(const object& o, const char* key) {
  std::string_view text;
  return o[key].get(text) == simdjson::SUCCESS ? std::string(text) : std::string();
}

std::uint64_t count_of(const object& o, const char* key) {
  std::uint64_t n = 0;
  return o[key].get(n) == simdjson::SUCCESS ? n : 0;
}

template <class Take>
void each(const object& o, const char* key, Take take) {
  simdjson::dom::array list;
  if (o[key].get(list) != simdjson::SUCCESS) return;
  for (const object entry : list) take(entry);
}

LastRun read(const object& o) {
  LastRun out;
  out.run = o["night"];
  out.date = text_of(o, "date");
  if (const std::string own = text_of(o, "language"); !own.empty()) out.language = own;
  const object counts = o["counts"];
  out.campaigns = count_of(counts, "campaigns");
  out.done = count_of(counts, "done");
  out.unchanged = count_of(counts, "unchanged");
  each(o, "failed", [&](const object& f) {
    object since;
    std::string day;
    if (f["failed_since"].get(since) == simdjson::SUCCESS && count_of(since, "night") < out.run)
      day = text_of(since, "date");
    out.failed.push_back({text_of(f, "id"), text_of(f, "folder"), text_of(f, "reason"), day});
  });
  each(o, "vanished", [&](const object& v) {
    out.vanished.push_back({text_of(v, "campaign"), text_of(v, "folder"),
                            count_of(v, "last_done_night"), text_of(v, "message")});
  });
  each(o, "issued", [&](const object& i) { out.issued.push_back(text_of(i, "number")); });
  each(o, "drafts", [&](const object& d) { out.waiting.push_back(text_of(d, "campaign")); });
  out.history_error = text_of(o, "history_error");
  return out;
}

}  // namespace

Expected<LastRun> last_run_in(const std::filesystem::path& out) {
  const std::filesystem::path path = out / "summary.json";
  const auto text = storage::read_file(path);
  if (!text)
    return fail("no run is complete in " + out.string() +
                "; expected the output folder of `nonio run`: " + text.error().message);
  try {
    simdjson::dom::parser parser;
    const object whole = parser.parse(*text);
    if (text_of(whole, "schema") != "nonio-summary/1")
      return fail(path.string() + ": expected schema nonio-summary/1, found \"" +
                  text_of(whole, "schema") + "\"");
    return read(whole);
  } catch (const simdjson::simdjson_error& e) {
    if (e.error() == simdjson::MEMALLOC) throw std::bad_alloc();
    return fail(path.string() + " cannot be read: " + e.what());
  }
}

}  // namespace nonio::assessment
