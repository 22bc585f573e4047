"use strict";
// Filters and keys for worklist lines below `root`. `until`: {signal} that removes the listeners.
// The URL stores the filters, so that it can be sent: index.html#customer=Rossi&kind=out
function nonioLines(root, until = {}) {
  const rows = [...root.querySelectorAll("tr[data-kind]")];
  const filters = [...root.querySelectorAll(".filters select")];
  function readAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    for (const s of filters) {
      s.value = wanted.get(s.name) || "";
      if (s.selectedIndex < 0) s.value = "";
    }
    apply();
  }
  function apply() {
    let shown = 0;
    for (const row of rows) {
      row.hidden = filters.some((s) => s.value !== "" && row.dataset[s.name] !== s.value);
      if (!row.hidden) shown += 1;
    }
    const count = root.querySelector("#shown");
    if (count) count.textContent = `${shown} / ${rows.length}`;
  }
  function writeAddress() {
    const chosen = new URLSearchParams();
    for (const s of filters) if (s.value !== "") chosen.set(s.name, s.value);
    history.replaceState(null, "", "#" + chosen.toString());
    apply();
  }
  if (filters.length > 0) {
    root.querySelector(".filters").hidden = false;
    for (const s of filters) s.addEventListener("change", writeAddress);
    addEventListener("hashchange", readAddress, until);
    readAddress();
  }
  // j and k select the next or previous line, Enter opens it.
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest("select, input, textarea, dialog")) return;
    const visible = rows.filter((row) => !row.hidden);
    const at = visible.indexOf(document.activeElement);
    if (event.key === "j" || event.key === "k") {
      const next = visible[event.key === "j" ? Math.min(at + 1, visible.length - 1) : Math.max(at - 1, 0)];
      if (next) { next.focus(); event.preventDefault(); }
    } else if (event.key === "Enter" && at >= 0) {
      const target = visible[at].querySelector("a");
      if (target && document.activeElement === visible[at]) target.click();
    }
  }, until);
}
