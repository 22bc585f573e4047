// SPDX-License-Identifier: Apache-2.0
#include "pages.h"

namespace nonio::reports {

Expected<std::vector<Artifact>> site_pages(const SiteHistory& history, const Templates& templates,
                                           const std::string& language) {
  const Wording words(templates, language, {"site"});
  const site::Page root{history, templates, words, ""}, below{history, templates, words, "../"};
  std::vector<Artifact> out{{"index.html", site::index_page(root)},
                            {"due.html", site::due_page(root)},
                            {"due.ics", site::due_calendar(root)},
                            {"instruments.html", site::instruments_page(root)},
                            {"compare.html", site::compare_page(root)}};
  for (const MachineHistory& m : history.machines)
    out.push_back({"machines/" + m.file, site::machine_page(below, m)});
  if (auto complete = words.complete(); !complete) return fail(complete.error());
  return out;
}

}  // namespace nonio::reports
