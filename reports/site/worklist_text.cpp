// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "html.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::reports {

namespace {

using Kind = WorkItem::Kind;
using State = WorkItem::State;
using site::Page;

std::string head_of(const Page& page, const WorkItem& l) {
  const std::string kind = page.words.get("site.kind." + std::string(site::name_of(l.kind)));
  if (l.state == State::fixed) return page.words.get("site.kind.fixed");
  if (l.state == State::known) return page.words.get("site.known", {{"kind", kind}});
  return kind;
}

std::string where_of(const WorkItem& l) {
  if (l.machine.empty()) return l.campaign + (l.axis.empty() ? "" : " " + l.axis);
  return l.machine + (l.axis.empty() ? "" : " " + l.axis);
}

std::string number_of(const Page& page, const WorkItem& l) {
  std::string out = site::quantity_text(page, l);
  if (!site::shows_value(l)) return out;
  out += (out.empty() ? "" : " ") + site::value_text(page, *l.value, l.u, l.unit, l.limit);
  return out + site::limit_text(page, l);
}

void say(std::string& line, const std::string& sentence) {
  if (!sentence.empty()) line += " " + sentence;
}

std::string text_of(const Page& page, const WorkItem& l) {
  const auto part = [&](const char* name) { return typeset(site::line_text(page, l, name)); };
  std::string line = head_of(page, l);
  const std::string where = where_of(l), number = number_of(page, l);
  if (!where.empty() || !number.empty()) line += "  ";
  line += where + (where.empty() || number.empty() ? "" : ": ") + number;
  if (!where.empty() || !number.empty())
    line += number.empty() ? ":" : ".";
  else
    line += " ";
  say(line, part("says"));
  say(line, site::also_text(page, l));
  say(line, site::since_text(page, l));
  if (l.state == State::known)
    say(line,
        page.words.get("site.acknowledged", {{"by", l.by}, {"until", l.until}, {"why", l.why}}));
  else
    say(line, part("advice"));
  if (!l.link.empty()) say(line, "[" + l.link + "]");
  return line + "\n";
}

}  // namespace

Expected<std::string> worklist_text(const SiteHistory& history, const Templates& templates,
                                    const std::string& language, std::size_t most) {
  const Wording words(templates, language, {"site"});
  const Page page{history, templates, words, ""};
  std::string out;
  std::map<Kind, std::size_t> more;
  for (std::size_t i = 0; i < history.lines.size(); ++i) {
    if (i < most)
      out += text_of(page, history.lines[i]);
    else
      ++more[history.lines[i].kind];
  }
  std::string rest;
  for (const auto& [kind, count] : more)
    rest += (rest.empty() ? "" : ", ") +
            words.get("site.kind." + std::string(site::name_of(kind))) + " " +
            std::to_string(count);
  if (!rest.empty()) out += words.get("site.more", {{"lines", rest}}) + "\n";
  if (history.lines.empty() && history.hidden > 0)
    out = words.get("site.none_of", {{"count", std::to_string(history.hidden)}}) + "\n";
  else if (history.lines.empty())
    out = words.get(history.judged ? "site.nothing" : "site.not_judged") + "\n";
  if (auto complete = words.complete(); !complete) return fail(complete.error());
  return out;
}

bool asks(const WorkItem& line) {
  return line.state == State::fresh && line.kind != Kind::information;
}

bool asks_by_mail(const WorkItem& line) { return asks(line) && line.sure; }

}  // namespace nonio::reports
