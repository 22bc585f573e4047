// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/site_logs.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <functional>

#include "campaign/config/checks.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/files.h"

namespace nonio::config {
namespace fs = std::filesystem;

bool is_site_part(std::string_view path) {
  for (const std::string_view file : {site_name, events_name, acknowledged_name, forgotten_name})
    if (path == file) return true;
  for (const std::string_view folder : {machines_folder, templates_folder, causes_folder})
    if (path == folder || (path.starts_with(folder) && path[folder.size()] == '/')) return true;
  return false;
}

namespace {

bool takes_back(const Withdrawal& w, const Acknowledgement& a) {
  return a.line < w.line && a.finding == w.finding && a.machine == w.machine && a.axis == w.axis &&
         a.quantity == w.quantity;
}

Checked<Entries> parse_log(std::string_view text, const std::string& file, const Key& declaration) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  Entries logs;
  TableReader top(*root, declaration, file, errors);
  top.fill(logs);
  top.finish();
  for (const Withdrawal& w : logs.withdrawn)
    if (std::erase_if(logs.acknowledged,
                      [&](const Acknowledgement& a) { return takes_back(w, a); }) == 0)
      errors.push_back(
          Error{"[[withdrawn]] takes back no acknowledgement above it: none that "
                "active has this finding, machine, axis and quantity",
                file, w.line});
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return logs;
}

Expected<std::string> text_of_log(const fs::path& site, const char* name) {
  NONIO_TRY(const auto there, storage::is_there(site / name));
  if (!there) return std::string();
  auto text = storage::read_small_file(site / name);
  if (!text) return fail(Error{text.error().message, name});
  return text;
}

template <class T>
Expected<void> take_log(const fs::path& site, const char* name,
                        Checked<std::vector<T>> (*parse)(std::string_view, const std::string&),
                        std::vector<T>& into, std::vector<Error>& errors) {
  NONIO_TRY(const auto text, text_of_log(site, name));
  if (text.empty()) return {};
  auto parsed = parse(text, name);
  if (parsed)
    into = std::move(*parsed);
  else
    errors.insert(errors.end(), parsed.error().begin(), parsed.error().end());
  return {};
}

class Entry {
 public:
  explicit Entry(const char* name) : text_(std::string("[[") + name + "]]\n") {}
  Entry& text(const char* key, const std::string& value) {
    if (!value.empty()) text_ += std::string(key) + " = " + quoted_toml(value) + "\n";
    return *this;
  }
  Entry& date(const char* key, const std::string& value) {
    const bool is_day =
        value.find_first_not_of("0123456789-") == std::string::npos && !value.empty();
    text_ += std::string(key) + " = " + (is_day ? value : quoted_toml(value)) + "\n";
    return *this;
  }
  Entry& number(const char* key, const std::optional<double>& value) {
    if (!value) return *this;
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), *value).ptr;
    text_ += std::string(key) + " = " + std::string(digits.data(), end) + "\n";
    return *this;
  }
  const std::string& all() const { return text_; }

 private:
  std::string text_;
};

/// Excludes other Nonio processes that write to the site, but not editors.
class SiteLock {
 public:
  explicit SiteLock(const fs::path& site)
      : fd_(::open(site.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (fd_ >= 0 && ::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      ::close(fd_);
      fd_ = -1;
    }
  }
  SiteLock(const SiteLock&) = delete;
  SiteLock& operator=(const SiteLock&) = delete;
  ~SiteLock() {
    if (fd_ >= 0) ::close(fd_);
  }
  explicit operator bool() const { return fd_ >= 0; }

 private:
  int fd_;
};

std::vector<Error> one(Error error) { return {std::move(error)}; }

using Check = std::function<Checked<std::size_t>(const std::string&)>;
using Adds = bool (*)(std::size_t before, std::size_t after);

Checked<void> append(
    const fs::path& site, const char* name, const std::string& entry, const Check& count,
    Adds adds = [](std::size_t before, std::size_t after) { return after == before + 1; }) {
  const SiteLock lock(site);
  if (!lock)
    return tl::unexpected(one(Error{"cannot be written now: the site " + site.string() +
                                        " does not exist, or another process is writing to it",
                                    name}));
  const auto before = text_of_log(site, name);
  if (!before) return tl::unexpected(one(before.error()));
  const auto entries = before->empty() ? Checked<std::size_t>(0) : count(*before);
  if (!entries) return tl::unexpected(entries.error());
  std::string after = before->empty() ? "format = 1\n" : *before;
  if (!after.ends_with('\n')) after += '\n';
  after += "\n" + entry;
  const auto now = count(after);
  if (!now) return tl::unexpected(now.error());
  if (!adds(*entries, *now))
    return tl::unexpected(one(Error{"the new entry would not be read as one", name}));
  if (const auto meanwhile = text_of_log(site, name); !meanwhile || *meanwhile != *before)
    return tl::unexpected(
        one(Error{"another process has changed it in the meantime; nothing was written", name}));
  if (const auto written = storage::publish(site, {{name, after}}); !written)
    return tl::unexpected(one(written.error()));
  return {};
}

template <class T>
Check counts(Checked<std::vector<T>> (*parse)(std::string_view, const std::string&),
             const char* name) {
  return [=](const std::string& text) -> Checked<std::size_t> {
    const auto parsed = parse(text, name);
    if (!parsed) return tl::unexpected(parsed.error());
    return parsed->size();
  };
}

}  // namespace

bool Event::concerns(const std::string& of) const {
  if (axis.empty() || of.empty() || axis == of) return true;
  return of.starts_with(axis) &&
         of.find_first_not_of("0123456789", axis.size()) == std::string::npos;
}

template <class Entry>
void check_entry(TableReader& reader, Entry& entry) {
  entry.line = reader.line();
  if constexpr (requires { entry.finding; })
    if (constexpr std::string_view former = "morning."; entry.finding.starts_with(former))
      entry.finding.replace(0, former.size(), "worklist.");
  if constexpr (requires { entry.why; })
    if (!entry.why.empty() && !has_content(entry.why))
      reader.error("why", "expected a reason in words, found \"" + entry.why + "\"");
  if constexpr (requires { entry.until; })
    if (!entry.until.empty() && entry.until < entry.date)
      reader.error("until", "expected a day that is not before date, " + entry.date);
}
template void check_entry(TableReader&, Event&);
template void check_entry(TableReader&, Acknowledgement&);
template void check_entry(TableReader&, Withdrawal&);
template void check_entry(TableReader&, Forgotten&);

Checked<std::vector<Event>> parse_events(std::string_view text, const std::string& file) {
  auto logs = parse_log(text, file, events_file());
  if (!logs) return tl::unexpected(logs.error());
  return std::move(logs->events);
}

Checked<std::vector<Acknowledgement>> parse_acknowledged(std::string_view text,
                                                         const std::string& file) {
  auto logs = parse_log(text, file, acknowledged_file());
  if (!logs) return tl::unexpected(logs.error());
  return std::move(logs->acknowledged);
}

Checked<std::vector<Forgotten>> parse_forgotten(std::string_view text, const std::string& file) {
  auto logs = parse_log(text, file, forgotten_file());
  if (!logs) return tl::unexpected(logs.error());
  return std::move(logs->forgotten);
}

Checked<SiteLogs> read_site_logs(const fs::path& site) {
  SiteLogs logs;
  std::vector<Error> errors;
  const auto note = [&](const Expected<void>& taken) {
    if (!taken) errors.push_back(taken.error());
  };
  note(take_log(site, events_name, parse_events, logs.events, errors));
  note(take_log(site, acknowledged_name, parse_acknowledged, logs.acknowledged, errors));
  note(take_log(site, forgotten_name, parse_forgotten, logs.forgotten, errors));
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return logs;
}

Checked<void> add_event(const fs::path& site, const Event& e) {
  Entry entry("event");
  entry.date("date", e.date).text("machine", e.machine).text("axis", e.axis);
  entry.text("kind", e.kind).text("text", e.text).text("by", e.by);
  return append(site, events_name, entry.all(), counts(parse_events, events_name));
}

Checked<void> add_acknowledgement(const fs::path& site, const Acknowledgement& a) {
  Entry entry("acknowledged");
  entry.date("date", a.date).text("finding", a.finding).text("machine", a.machine);
  entry.text("axis", a.axis).text("quantity", a.quantity).date("until", a.until);
  entry.number("value", a.value).number("U", a.U).text("by", a.by).text("why", a.why);
  return append(site, acknowledged_name, entry.all(),
                counts(parse_acknowledged, acknowledged_name));
}

Checked<void> add_withdrawal(const fs::path& site, const Withdrawal& w) {
  Entry entry("withdrawn");
  entry.date("date", w.date).text("finding", w.finding).text("machine", w.machine);
  entry.text("axis", w.axis).text("quantity", w.quantity).text("by", w.by).text("why", w.why);
  return append(site, acknowledged_name, entry.all(), counts(parse_acknowledged, acknowledged_name),
                [](std::size_t before, std::size_t after) { return after < before; });
}

Checked<void> add_forgotten(const fs::path& site, const Forgotten& f) {
  if (!is_campaign_id(f.campaign) && !is_site_part(f.campaign))
    return tl::unexpected(one(Error{
        "expected the id of a campaign, or a file or folder of the site (machines/S-0042.toml, "
        "templates, events.toml); found \"" +
            f.campaign + "\"",
        forgotten_name}));
  Entry entry("forgotten");
  entry.date("date", f.date).text("campaign", f.campaign).text("by", f.by).text("why", f.why);
  return append(site, forgotten_name, entry.all(), counts(parse_forgotten, forgotten_name));
}

}  // namespace nonio::config
