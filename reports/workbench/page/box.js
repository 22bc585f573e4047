// ---- parts of both pages: a dialog, the text for screen readers, the alarm at the top ----
const box = (() => {
  const button = (id, word, more = {}) => el("button", {type: "button", id, ...more}, say(word));
  const places = () => [el("div", {id: "said", class: "unseen", "aria-live": "polite"}), el("dialog", {id: "dialog", "aria-labelledby": "dialog-title"})];
  /// Identifies the element that has the focus, or its line of a list, so that it is found again after a redraw.
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
  /// A dialog with a title; returns its element. When it closes, the focus returns to its opener, even if that was redrawn.
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
