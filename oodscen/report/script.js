(() => {
  "use strict";
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const get = (id) => document.getElementById(id);

  for (const tools of all(".tools")) {
    tools.hidden = false;
    tools.addEventListener("click", (event) => {
      const order = event.target.dataset.tree;
      if (!order) return;
      for (const branch of all(".outline details", tools.parentElement)) branch.open = order === "open";
    });
  }

  const filters = document.querySelector(".filters");
  let reset = () => {};
  if (filters) {
    const text = get("f-text"), kind = get("f-kind"), choice = get("f-choice"), failed = get("f-failed");
    const clear = get("f-reset"), shown = get("f-shown"), none = get("f-none");
    const paths = all("section.path").map((section) => ({
      section,
      kind: section.dataset.kind,
      cards: all(".card", section).map((card) => ({
        card,
        choice: card.dataset.choice,
        failed: card.classList.contains("failed"),
        words: [card.id, section.firstElementChild, card.querySelector(".text")]
          .map((part) => (part && part.textContent) || (typeof part === "string" ? part : ""))
          .join(" ").toLowerCase(),
      })),
    }));
    const total = paths.reduce((sum, path) => sum + path.cards.length, 0);
    const apply = () => {
      const words = text.value.toLowerCase().split(/\s+/).filter(Boolean);
      let count = 0;
      for (const path of paths) {
        let here = 0;
        const fits = !kind.value || path.kind === kind.value;
        for (const item of path.cards) {
          const on = fits && (!choice.value || item.choice === choice.value)
            && (!failed.checked || item.failed) && words.every((word) => item.words.includes(word));
          if (item.card.hidden === on) item.card.hidden = !on;
          if (on) here += 1;
        }
        path.section.hidden = !here;
        count += here;
      }
      shown.value = count === total ? `${total} scenes` : `${count} of ${total} scenes`;
      clear.hidden = count === total;
      none.hidden = count > 0;
    };
    let waiting = 0;
    filters.addEventListener("input", () => {
      clearTimeout(waiting);
      waiting = setTimeout(apply, 40);
    });
    reset = () => {
      text.value = kind.value = choice.value = "";
      failed.checked = false;
      apply();
    };
    clear.addEventListener("click", () => { reset(); text.focus(); });
    document.addEventListener("keydown", (event) => {
      const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement.tagName);
      if (event.key === "/" && !typing && !event.ctrlKey && !event.metaKey) {
        event.preventDefault();
        text.focus();
      }
      if (event.key === "Escape" && document.activeElement === text) reset();
    });
    filters.hidden = false;
    apply();
  }

  const reveal = () => {
    let target = null;
    try { target = get(decodeURIComponent(location.hash.slice(1))); } catch { return; }
    if (!target || !location.hash) return;
    if (target.closest("[hidden]")) reset();
    for (let box = target.closest("details"); box; box = box.parentElement.closest("details")) box.open = true;
    // Cards above the target get their true heights only once they have been near the screen.
    target.scrollIntoView();
    for (const delay of [50, 250]) setTimeout(() => target.scrollIntoView(), delay);
  };
  addEventListener("hashchange", reveal);
  reveal();
})();
