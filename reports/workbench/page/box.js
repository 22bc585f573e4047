// ---- what both pages have: a dialog, what is spoken, the alarm at the top ----
const box = (() => {
  const button = (id, word, more = {}) => el("button", {type: "button", id, ...more}, say(word));
  const places = () => [el("div", {id: "said", class: "unseen", "aria-live": "polite"}), el("dialog", {id: "dialog", "aria-labelledby": "dialog-title"})];
  /// A dialog with a title; gives its body. Esc closes it, the focus returns.
  function dialog(title, ...content) {
    const place = by("dialog");
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
  return {button, places, dialog, speak, alarm};
})();
