// SPDX-License-Identifier: Apache-2.0
#include "host/morning/kept_machines.h"

#include "host/morning/bytes.h"
#include "host/storage/digest.h"
#include "host/storage/files.h"

namespace nonio {

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Number>
void fields(Io& io, T& n) { io(n.name, n.value, n.quantity); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Finding>
void fields(Io& io, T& f) { io(f.id, f.attention, f.evidence, f.texts, f.measurement, f.advice); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, HistoryPoint>
void fields(Io& io, T& p) {
  io(p.campaign, p.date, p.link, p.state, p.value, p.u, p.joined, p.why_not, p.u_common);
}

/// Of one that is only compared.
template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, HistorySeries>
void fields(Io& io, T& s) { io(s.axis, s.quantity, s.unit, s.points, s.model); }

}  // namespace nonio

namespace nonio::reports {

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, MorningLine>
void fields(Io& io, T& l) {
  io(l.kind, l.state, l.id, l.machine, l.axis, l.quantity, l.campaign, l.customer, l.value, l.u,
     l.limit, l.unit, l.finding, l.since, l.link, l.by, l.until, l.why, l.sure);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, IntervalProposal>
void fields(Io& io, T& p) { io(p.months, p.method, p.axis, p.quantity, p.why); }

/// Of one that is only compared.
template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, MachineHistory>
void fields(Io& io, T& m) {
  io(m.id, m.maker, m.model, m.serial, m.customer, m.place, m.control, m.series, m.due, m.why_due,
     m.file);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, MonthOfMachine>
void fields(Io& io, T& m) { io(m.machine, m.month, m.gravest, m.measured, m.event); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, InstrumentUse::On>
void fields(Io& io, T& on) { io(on.campaign, on.date, on.machine, on.number, on.link); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, InstrumentUse>
void fields(Io& io, T& use) { io(use.name, use.certificate, use.valid_until, use.results); }

}  // namespace nonio::reports

namespace nonio::history {

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Slope>
void fields(Io& io, T& s) { io(s.b, s.u); }

}  // namespace nonio::history

namespace nonio::host::morning {
namespace fs = std::filesystem;

namespace {

/// Another program may find out something else.
constexpr std::string_view machines_magic = "nonio-machines/4 " NONIO_VERSION "\n";
constexpr const char* machines_folder = ".nonio";
constexpr const char* machines_name = "machines";
constexpr std::size_t digest_size = 64;

}  // namespace

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Lesson>
void fields(Io& io, T& l) { io(l.quantity, l.points, l.ratios, l.slope); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Manner>
void fields(Io& io, T& m) { io(m.excess, m.spread, m.drift_below); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, SeriesTests::Of>
void fields(Io& io, T& t) { io(t.p, t.declared, t.shows_instrument); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, SeriesTests>
void fields(Io& io, T& t) { io(t.night, t.has_model, t.changes); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, IntervalFacts>
void fields(Io& io, T& f) {
  io(f.maker, f.model, f.days, f.months, f.tested, f.found, f.chart, f.refusal);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, Standing>
void fields(Io& io, T& s) {
  io(s.shown, s.lines, s.months, s.instruments, s.has_results, s.judged, s.conforms, s.attention,
     s.reversal, s.interval, s.until);
}

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, KeptMachine::Series>
void fields(Io& io, T& s) { io(s.lesson, s.manner, s.tests); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, KeptMachine::Page>
void fields(Io& io, T& p) { io(p.made_from, p.size, p.changed); }

template <class Io, class T>
requires std::is_same_v<std::remove_const_t<T>, KeptMachine>
void fields(Io& io, T& m) { io(m.rows, m.series, m.fits, m.stood, m.date, m.standing, m.page); }

KeptMachines KeptMachines::in(const fs::path& out) {
  const fs::path path = out / machines_folder / machines_name;
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  const auto file = storage::read_file(path);
  if (!file || file->size() < machines_magic.size() + digest_size) return {};
  const std::string_view all(*file);
  const std::string_view body = all.substr(0, all.size() - digest_size);
  if (!body.starts_with(machines_magic) || storage::sha256(body) != all.substr(body.size()))
    return {};
  ByteReader r(body.substr(machines_magic.size()));
  KeptMachines kept;
  kept.bytes = file->size();
  r.each([&] {
    auto& [made_from, asked] = kept.nights[r.get<std::uint64_t>()];
    r(made_from, asked);
  });
  r.each([&] {
    std::string name;
    r(name);
    r(kept.machines[name]);
  });
  return r.well() && r.at_end() ? kept : KeptMachines{};
}

void KeptMachines::keep_in(const fs::path& out) const {
  ByteWriter w;
  w.reserve(bytes + bytes / 8);
  w.put_raw(machines_magic);
  w.put(static_cast<std::uint64_t>(nights.size()));
  for (const auto& [number, night] : nights) w(number, night.made_from, night.asked);
  w.put(static_cast<std::uint64_t>(machines.size()));
  for (const auto& [name, machine] : machines) w(name, machine);
  std::string body = w.take();
  body += storage::sha256(body);
  [[maybe_unused]] const auto kept =
      storage::publish(out / machines_folder, {{machines_name, std::move(body)}});
}

std::string bytes_of(const std::vector<reports::MorningLine>& lines) {
  ByteWriter w;
  w(lines);
  return w.take();
}

std::string bytes_of(const reports::IntervalProposal& proposal) {
  ByteWriter w;
  w(proposal);
  return w.take();
}

}  // namespace nonio::host::morning
