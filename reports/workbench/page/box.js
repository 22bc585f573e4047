// ---- what both pages have: a dialog, what is spoken, the alarm at the top ----
const box = (() => {
  const button = (id, word, more = {}) => el("button", {type: "button", id, ...more}, say(word));
  const places = () => [el("div", {id: "said", class: "unseen", "aria-live": "polite"}), el("dialog", {id: "dialog", "aria-labelledby": "dialog-title"})];
  /// What has the focus, to be found again among elements that were made anew: itself, or the line of a list it stands in.
  function focused() {
    const e = document.activeElement, line = e && e.closest("tr[data-line]");
    return {key: e && e.dataset.key, line: line && line.dataset.line};
  }
  function focusAgain({key, line}) {
    const all = [...document.querySelectorAll("[data-key], tr[data-line]")];
    const again = (key && all.find((e) => e.dataset.key === key)) || (line && all.find((e) => e.dataset.line === line));
    if (again) again.focus({preventScroll: true});
  }
  let opener = {};
  /// A dialog with a title; gives its body. Esc closes it, the focus returns, also to what was drawn anew meanwhile.
  function dialog(title, ...content) {
    const place = by("dialog");
    if (!place.open) {
      opener = focused();
      place.onclose = () => {
        const now = document.activeElement;
        if (!now || now === document.body || place.contains(now)) focusAgain(opener);
      };
    }
    place.replaceChildren(el("h2", {id: "dialog-title"}, title), ...content.flat());
    if (!place.open) place.showModal();
    return place;
  }
  let quiet = 0;
  function speak(text) {
    clearTimeout(quiet);
    quiet = setTimeout(() => (by("said").textContent = text), 300);
  }
  function alarm(text, ...more) {
    const place = by("alarm");
    place.hidden = text === "";
    place.replaceChildren(text, ...more);
  }
  return {button, places, dialog, focused, focusAgain, speak, alarm};
})();
