(() => {
  "use strict";
  const BATCH = 40;
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const get = (id) => document.getElementById(id);
  const data = JSON.parse(get("data").textContent);
  const scenes = data.scenes, models = data.models;
  const number = new Map(scenes.map((scene, index) => [scene.id, index]));
  const leaves = new Map(Object.entries(data.leaves));

  // Everything is built from text nodes and known attributes; no string is ever parsed as markup.
  const NS = "http://www.w3.org/2000/svg";
  const fill = (node, attributes, children) => {
    for (const [name, value] of Object.entries(attributes)) if (value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
    node.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== ""));
    return node;
  };
  const el = (name, attributes = {}, ...children) => fill(document.createElement(name), attributes, children);
  const svg = (name, attributes = {}, ...children) => fill(document.createElementNS(NS, name), attributes, children);
  const said = (text) => el("bdi", {}, text);
  const sr = (text) => el("span", { class: "sr" }, text);
  const member = (record, name) => Object.hasOwn(record, name) ? record[name] : undefined;
  const words = (id) => id.replaceAll("_", " ").replaceAll("-", " ");
  const leafName = (leaf) => leaf === "none" ? "nothing unusual" : (leaves.get(leaf)?.path.at(-1) ?? words(leaf));
  const anchor = (scene) => `#scene-${encodeURIComponent(scene.id)}`;

  // The list and its filters
  const form = get("filters"), list = get("list"), more = get("more");
  let fits = scenes, built = 0, leaf = "", listHash = "#scenes";

  // The ordinary drives of a scene, each with its name
  const drives = (scene) => [["Ordinary twin", scene?.twin], ["Ordinary demand", scene?.demand]].filter(([, one]) => one);
  const texts = new Map();
  const searched = (scene) => {
    if (!texts.has(scene)) {
      const said = [scene, ...drives(scene).map(([, one]) => one)].flatMap((one) => one.answers ?? []).flatMap((answer) => [answer.aspect, answer.reasoning, ...(answer.descriptions ?? [])]);
      texts.set(scene, [scene.id, scene.text, scene.error, ...(leaves.get(scene.leaf)?.path ?? []), ...said].filter(Boolean).join(" ").toLowerCase());
    }
    return texts.get(scene);
  };
  const RESULTS = {
    safe: (own) => own?.safe === true,
    unsafe: (own) => own?.safe === false,
    named: (own) => own?.named === true,
    unnamed: (own) => own?.named === false,
    missed: (own) => own?.ood === false,
    alarm: (own, others) => others.some((one) => one.ood === true),
    silent: (own, others) => [own, ...others].some((one) => one && one.outcome !== "answered" && one.outcome !== "unavailable"),
    contradiction: (own, others) => [own, ...others].some((one) => Boolean(one?.contradiction)),
  };
  const by = (scene, model) => scene?.answers.find((answer) => answer.model === model);
  const others = (scene, model) => drives(scene).map(([, one]) => by(one, model)).filter(Boolean);
  const accepts = (scene, want) => {
    const path = leaves.get(scene.leaf)?.path ?? [];
    if (leaf && scene.leaf !== leaf) return false;
    if (want.class && path[0] !== want.class) return false;
    if (want.family && path[1] !== want.family) return false;
    if (want.map && scene.map !== want.map) return false;
    if (want.weather && !scene.weather.includes(want.weather)) return false;
    if (want.outcome === "failed" ? !scene.error : want.outcome && scene.choice !== want.outcome) return false;
    if (want.behind && (!scene.actions.length || scene.followed !== (want.behind === "some"))) return false;
    if (want.safe && (!scene.actions.length || scene.actions.filter((action) => action.kind === "safe").length !== Number(want.safe))) return false;
    if (want.model || want.result) {
      const asked = want.model ? [Number(want.model)] : models.flatMap((one, index) => one.kind === "model" ? [index] : []);
      const test = member(RESULTS, want.result) ?? ((own) => Boolean(own));
      if (!asked.some((model) => test(by(scene, model), others(scene, model)))) return false;
    }
    const query = (want.q ?? "").toLowerCase().split(/\s+/).filter(Boolean);
    return !query.length || query.every((word) => searched(scene).includes(word));
  };
  const wanted = () => Object.fromEntries([...new FormData(form)].filter(([, value]) => value));

  const chip = (action, long) => el("li", { class: `is-${action.kind}`, title: long ? undefined : action.note },
    sr(`${action.kind}: `), el("b", {}, action.name), long ? el("span", {}, ` ${action.note}`) : null);
  const mark = (good, yes, no) => el("span", { class: `key verdict is-${good ? "safe" : "unsafe"}` }, good ? yes : no);
  const acted = (answer, tail = "") => answer.marginal ? el("span", { class: "key verdict" }, `marginal${tail}`)
    : answer.safe === null ? null : mark(answer.safe, `safe${tail}`, `unsafe${tail}`);
  const pathOf = (labels) => labels.length ? labels.flatMap((label, index) => [
    el("bdi", { class: index === labels.length - 1 ? "leaf" : undefined }, label),
    index < labels.length - 1 ? el("span", { class: "sep", "aria-hidden": "true" }, " › ") : null]) : [el("bdi", { class: "leaf" }, "Without a path")];
  const photo = (frame, alt) => {
    if (!frame.href) return el("span", { class: "noframe" }, frame.problem);
    const image = el("img", { src: frame.href, alt, width: 640, height: 480, loading: "lazy", decoding: "async" });
    const link = el("a", { href: frame.href }, image);
    image.addEventListener("error", () => link.replaceChildren(el("span", { class: "noframe" }, "no picture beside this page")));
    return link;
  };
  const card = (scene) => {
    const last = scene.frames.at(-1);
    const judged = scene.answers.filter((answer) => models[answer.model].kind === "model").slice(0, 4);
    return el("article", { class: `card${scene.error ? " failed" : ""}`, "data-scene": scene.id, "aria-label": `Scene ${scene.id}` },
      last ? el("div", { class: "thumb" }, photo(last, `Last frame of ${scene.id}`)) : null,
      el("header", {}, el("a", { class: "id", href: anchor(scene) }, scene.id),
        scene.error ? el("span", { class: "badge bad" }, "failed") : null,
        scene.score ? el("span", { class: "score", title: "OOD-ness: −1 is worded like ordinary driving, 0 is unlike any of it" }, `OOD-ness ${scene.score}`) : null),
      scene.text ? el("p", { class: "text" }, said(scene.text)) : null,
      scene.error ? el("p", { class: "error" }, said(scene.error)) : null,
      scene.state ? el("p", { class: "gap" }, scene.state) : null,
      scene.actions.length ? el("ul", { class: "chips", "aria-label": "What each action leads to" }, scene.actions.map((action) => chip(action, false))) : null,
      judged.length ? el("ul", { class: "marks" }, judged.map((answer) => el("li", {}, said(models[answer.model].name), " ",
        answer.outcome !== "answered" ? el("span", { class: "badge bad" }, answer.outcome) : null,
        answer.named === null ? null : mark(answer.named, "names it", "does not name it"), " ",
        acted(answer, `: ${words(answer.action)}`)))) : null);
  };
  const extend = () => {
    if (built >= fits.length) return;
    for (const scene of fits.slice(built, built + BATCH)) {
      let cards = list.lastElementChild;
      if (!cards || cards.dataset.leaf !== scene.leaf) {
        const known = leaves.get(scene.leaf) ?? { path: [] };
        cards = el("section", { class: "path", "data-leaf": scene.leaf },
          el("h3", {}, el("a", { href: `#path-${encodeURIComponent(scene.leaf)}`, class: "plain" }, pathOf(known.path)), known.attested ? [" ", el("span", { class: "badge paper" }, "paper")] : null),
          el("div", { class: "cards" }));
        list.append(cards);
      }
      cards.lastElementChild.append(card(scene));
    }
    built = Math.min(built + BATCH, fits.length);
    more.hidden = built >= fits.length;
    more.textContent = `Show more (${fits.length - built} left)`;
  };
  const apply = () => {
    if (!form) return;
    const want = wanted();
    fits = scenes.filter((scene) => accepts(scene, want));
    list.replaceChildren();
    built = 0;
    extend();
    more.hidden = built >= fits.length;
    const limited = fits.length !== scenes.length || leaf;
    const failed = fits.filter((scene) => scene.error).length;
    get("shown").value = (limited ? `${fits.length} of ${scenes.length} scenes${leaf ? " on one path" : ""}` : `${scenes.length} scenes`)
      + (failed ? `, ${failed} of them failed` : "");
    get("f-reset").hidden = !limited && !Object.keys(want).length;
    get("none").hidden = fits.length > 0;
    const query = new URLSearchParams(want).toString();
    listHash = leaf ? `#path-${encodeURIComponent(leaf)}` : query ? `#scenes?${query}` : "#scenes";
  };

  // One scene
  const extent = (sketches) => {
    const known = sketches.filter(Boolean);
    const ways = known.flatMap((one) => Object.values(one.paths));
    const road = known.flatMap((one) => one.lanes).filter((lane) => lane[0] === "driving" || lane[0] === "shoulder").flatMap((lane) => [lane[2], lane[3]]);
    const aside = ways.flatMap((way) => way.filter((_, index) => index % 2 === 1));
    const near = known.flatMap((one) => Object.values(one.bodies)).filter((body) => body[0] > -30);
    return {
      left: Math.min(-8, ...near.map((body) => body[0] - body[3])),
      right: Math.min(130, Math.max(25, ...ways.flatMap((way) => way.filter((_, index) => index % 2 === 0))) + 8),
      top: Math.min(16, Math.max(2, ...road, ...aside) + 2),
      low: Math.max(-16, Math.min(-2, ...road, ...aside) - 2),
    };
  };
  const strip = (sketch, action, hazards, hits, { left, right, top, low }) => {
    const at = (x, y, heading = 0) => `translate(${x} ${-y}) rotate(${-heading})`;
    const block = (name, body, kind) => svg("rect", { class: `body ${kind}`, x: -body[3] / 2, y: -body[4] / 2, width: Math.max(body[3], 1), height: Math.max(body[4], 0.8), rx: 0.3, transform: at(body[0], body[1], body[2]) },
      svg("title", {}, name === "ego" ? "ego" : member(sketch.names, name) ?? name));
    const parts = sketch.lanes.map(([kind, way, from, to]) => svg("rect", { class: `lane is-${kind === "driving" ? (way < 0 ? "oncoming" : "driving") : "side"}`, x: left, y: -to, width: right - left, height: to - from }));
    sketch.lanes.forEach((lane, index) => {
      const next = sketch.lanes[index + 1];
      if (lane[0] === "driving" && next && next[0] === "driving") parts.push(svg("path", { class: lane[1] === next[1] ? "dashes" : "line", d: `M${left} ${-lane[3]}H${right}` }));
    });
    const path = member(sketch.paths, action) ?? [], ends = member(sketch.ends, action) ?? {};
    const kindOf = (name) => hits.includes(name) ? "is-hit" : hazards.includes(name) ? "is-hazard" : "is-other";
    for (const [name, body] of Object.entries(sketch.bodies)) {
      if (name === "ego") continue;
      const end = member(ends, name);
      if (end) {
        parts.push(svg("path", { class: "way", d: `M${body[0]} ${-body[1]}L${end[0]} ${-end[1]}` }), block(name, body, `${kindOf(name)} ghost`));
        parts.push(block(name, [end[0], end[1], end[2], body[3], body[4]], kindOf(name)));
      } else parts.push(block(name, body, kindOf(name)));
    }
    const ego = sketch.bodies.ego ?? [0, 0, 0, 4.5, 1.9];
    parts.push(block("ego", ego, "is-ego ghost"));
    if (path.length > 3) {
      const points = [];
      for (let index = 0; index < path.length; index += 2) points.push(`${path[index]},${-path[index + 1]}`);
      const [x, y] = path.slice(-2), [fromX, fromY] = path.slice(-4, -2);
      parts.push(svg("polyline", { class: "trail", points: points.join(" ") }));
      parts.push(block("ego", [x, y, Math.atan2(y - fromY, Math.max(x - fromX, 0.1)) * 57.3, ego[3], ego[4]], "is-ego"));
    }
    return svg("svg", { class: "strip", viewBox: `${left} ${-top} ${right - left} ${top - low}`, role: "img", "aria-label": `Seen from above: ${words(action)}` }, parts);
  };
  const rollouts = (scene, view) => el("ul", { class: "rollouts" }, scene.actions.map((action) => el("li", { class: `is-${action.kind}` },
    el("p", {}, el("b", {}, sr(`${action.kind}: `), action.name), " ", el("span", {}, action.note), action.more ? el("small", {}, action.more) : null),
    scene.sketch && member(scene.sketch.paths, action.id) ? strip(scene.sketch, action.id, scene.hazards, action.hits, view) : null)));
  const looks = (scene, title, name, view) => el("section", { class: "side" },
    el("h3", {}, title),
    scene.error ? el("p", { class: "error" }, said(scene.error)) : null,
    scene.state ? el("p", { class: "gap" }, scene.state) : null,
    scene.frames.length ? el("div", { class: "frames" }, scene.frames.map((frame) => el("figure", {}, photo(frame, `${frame.moment} frame of ${name}`), el("figcaption", {}, frame.caption)))) : null,
    scene.setting ? el("p", { class: "setting" }, scene.setting, scene.badWeather ? [" ", el("span", { class: "badge hazard" }, "the weather is a hazard")] : null) : null,
    scene.setting ? el("ul", { class: "players" }, scene.players.length ? scene.players.map((player) => el("li", {}, el("b", {}, player.name), player.hazard ? [" ", el("span", { class: "badge hazard" }, "hazard")] : null, el("span", {}, ` ${player.what}`))) : el("li", {}, "No other actors.")) : null,
    scene.decision ? el("p", { class: "setting" }, scene.decision) : null,
    scene.actions.length ? [el("h4", {}, "What each action leads to"), rollouts(scene, view)] : null,
    scene.facts.length ? el("details", { class: "more" }, el("summary", {}, "Details"), el("dl", {}, scene.facts.flatMap(([what, value]) => [el("dt", {}, what), el("dd", {}, value)]))) : null);
  const answerOf = (answer, isTwin) => {
    if (!answer) return el("p", { class: "none" }, "Was not asked.");
    const rows = [];
    const row = (name, ...value) => rows.push(el("dt", {}, name), el("dd", {}, ...value));
    if (answer.outcome !== "answered") row("Outcome", el("span", { class: "badge bad" }, answer.outcome), answer.error ? el("span", { class: "error" }, " ", said(answer.error)) : null);
    if (answer.ood !== null) row("Unusual?", mark(answer.ood !== isTwin, answer.ood ? "yes" : "no", answer.ood ? "yes" : "no"), answer.sure === null || answer.sure === undefined ? null : ` (${Math.round(100 * answer.sure)} % sure)`);
    if (answer.aspect) row("What", answer.named === null ? null : [mark(answer.named, "right", "wrong"), " "], "“", said(answer.aspect), "”", answer.judge ? el("small", {}, "scored by ", said(answer.judge)) : null);
    if (answer.choice) row("From the list", answer.chosen === null ? null : [mark(answer.chosen, "right", "wrong"), " "], said(leafName(answer.choice)));
    if (answer.action) row("Action", acted(answer), " ", said(words(answer.action)));
    if (answer.contradiction) row("Contradiction", said(answer.contradiction));
    const notes = answer.notes ?? [], descriptions = answer.descriptions ?? [];
    return [el("dl", { class: "said" }, rows),
      descriptions.length || answer.reasoning || notes.length || answer.outdated ? el("details", { class: "more" }, el("summary", {}, "In its own words"),
        descriptions.length ? el("ol", {}, descriptions.map((text) => el("li", {}, said(text)))) : null,
        answer.reasoning ? el("p", {}, el("b", {}, "Reasoning: "), said(answer.reasoning)) : null,
        notes.map((note) => el("p", { class: "aside" }, "Read as: ", said(note))),
        answer.outdated ? el("p", { class: "aside" }, "Answered an earlier version of the questions.") : null) : null];
  };
  const answers = (scene) => {
    const asked = models.map((model, index) => ({ ...model, index })).filter(({ index }) => by(scene, index) || others(scene, index).length);
    const real = asked.filter((model) => model.kind === "model"), references = asked.filter((model) => model.kind !== "model");
    const brief = (answer, isTwin) => answer ? [answer.ood === null ? null : el("span", {}, answer.ood ? "unusual" : "ordinary", "; "), answer.action ? [acted(answer), ` ${words(answer.action)}`] : "no action"] : "–";
    return [
      el("h3", {}, "What the models said"),
      real.length ? real.map((model) => el("section", { class: "answers" }, el("h4", {}, said(model.name)),
        el("div", { class: "sides" }, el("div", {}, drives(scene).length ? el("h5", {}, "Scene") : null, answerOf(by(scene, model.index), false)),
          drives(scene).filter(([, one]) => by(one, model.index)).map(([name, one]) => el("div", {}, el("h5", {}, name), answerOf(by(one, model.index), true)))))) : el("p", { class: "none" }, "No model was judged on it."),
      references.length ? el("details", { class: "fold" }, el("summary", {}, "Reference answerers"), el("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Reference answerers" }, el("table", { class: "plainer" },
        el("thead", {}, el("tr", {}, el("th", { scope: "col" }, "Reference"), el("th", { scope: "col" }, "Scene"), drives(scene).map(([name]) => el("th", { scope: "col" }, name)))),
        el("tbody", {}, references.map((model) => el("tr", {}, el("th", { scope: "row" }, said(model.name)), el("td", {}, brief(by(scene, model.index))), drives(scene).map(([, one]) => el("td", {}, brief(by(one, model.index)))))))))) : null];
  };
  const legend = () => el("p", { class: "aside legend" }, "Seen from above, driving to the right: ",
    [["ego", "ego"], ["hazard", "what is unusual"], ["other", "others"], ["hit", "what is hit"]].map(([kind, name]) => el("span", { class: "key" }, el("i", { class: `swatch body is-${kind}` }), name)),
    "Faint: where they are when the ego must choose. Solid: where they are in the end. Gap: the smallest distance to anything. TTC: the least time to a collision if nobody did anything else.");
  const page = get("page");
  let open = null;
  const show = (scene) => {
    open = scene;
    const place = fits.indexOf(scene), known = leaves.get(scene.leaf) ?? { path: [] };
    const view = extent([scene.sketch, ...drives(scene).map(([, one]) => one.sketch)]);
    const step = (other, text, rel) => other ? el("a", { href: anchor(other), rel, class: "step" }, text) : el("span", { class: "step none", "aria-hidden": "true" }, text);
    page.replaceChildren(el("article", { class: "whole", id: `scene-${scene.id}`, "aria-label": `Scene ${scene.id}` },
      el("nav", { class: "steps", "aria-label": "Scenes" }, el("a", { href: listHash, class: "step", id: "back" }, "↑ All scenes"),
        step(fits[place - 1], "← Previous", "prev"), step(place < 0 ? fits[0] : fits[place + 1], "Next →", "next"),
        place < 0 ? null : el("span", { class: "aside" }, `${place + 1} of ${fits.length}`)),
      el("p", { class: "crumbs" }, pathOf(known.path), known.attested ? [" ", el("span", { class: "badge paper" }, "paper")] : null),
      el("h2", { tabindex: "-1" }, scene.text ? said(scene.text) : scene.id),
      el("p", { class: "aside" }, el("code", {}, scene.id), scene.score ? [" · ", el("a", { href: "#metrics" }, "OOD-ness"), ` ${scene.score}`] : null, scene.nearest ? [" · nearest ordinary text: ", said(scene.nearest)] : null),
      drives(scene).filter(([, one]) => one.text).map(([name, one]) => el("p", { class: "aside" }, `${name}: `, said(one.text))),
      scene.sketch ? legend() : null,
      el("div", { class: "sides" }, looks(scene, "Scene", scene.id, view), drives(scene).map(([name, one]) => looks(one, name, `${scene.id}, ${name.toLowerCase()}`, view))),
      answers(scene)));
    page.hidden = false;
    document.body.classList.add("reading");
    document.title = `${scene.id} – study report`;
    scrollTo(0, 0);
    page.querySelector("h2").focus({ preventScroll: true });
  };
  const title = document.title;
  const leave = () => {
    if (!open) return;
    const was = open;
    open = null;
    page.hidden = true;
    page.replaceChildren();
    document.body.classList.remove("reading");
    document.title = title;
    while (built < fits.length && built <= fits.indexOf(was)) extend();
    const link = all(".card", list ?? document).find((one) => one.dataset.scene === was.id)?.querySelector(".id");
    return link;
  };

  // Addresses
  const unknown = get("unknown");
  const miss = (what) => {
    if (!unknown) return;
    unknown.textContent = what;
    unknown.hidden = false;
    unknown.scrollIntoView({ block: "center" });
    unknown.focus({ preventScroll: true });
  };
  const follow = () => {
    let name = location.hash.slice(1);
    if (unknown) unknown.hidden = true;
    try { name = decodeURIComponent(name); } catch { return; }
    if (name.startsWith("scene-")) {
      const scene = scenes[number.get(name.slice(6).replace(/~(twin|demand)$/, ""))];
      if (scene) { show(scene); return; }
    }
    const back = leave();
    if (name.startsWith("scene-")) { miss(`There is no scene “${name.slice(6)}” in this study; all it has are listed below.`); return; }
    if (back && location.hash === listHash) {
      back.scrollIntoView({ block: "center" });
      back.focus({ preventScroll: true });
      return;
    }
    if (form && name.startsWith("path-")) {
      for (const control of form.elements) if (control.name) control.value = "";
      leaf = leaves.has(name.slice(5)) ? name.slice(5) : "";
      apply();
      if (leaf) get("scenes").scrollIntoView();
      else miss(`There is no path “${name.slice(5)}” in this study; all its scenes are listed below.`);
      return;
    }
    if (form && name.startsWith("scenes?")) {
      const want = new URLSearchParams(location.hash.slice(8));
      leaf = "";
      for (const control of form.elements) if (control.name) control.value = want.get(control.name) ?? "";
      apply();
      get("scenes").scrollIntoView();
    } else if (form && leaf && name === "scenes") { leaf = ""; apply(); }
    const target = get(name);
    if (target) {
      for (let box = target.closest("details"); box; box = box.parentElement.closest("details")) box.open = true;
      target.scrollIntoView();
    }
  };

  for (const tools of all(".tools")) {
    tools.hidden = false;
    tools.addEventListener("click", (event) => {
      const order = event.target.dataset.tree;
      if (!order) return;
      for (const branch of all(".outline details", tools.parentElement)) branch.open = order === "open";
    });
  }
  if (form) {
    form.hidden = false;
    const changed = () => { leaf = ""; apply(); history.replaceState(null, "", listHash); };
    let waiting = 0;
    form.addEventListener("input", () => { clearTimeout(waiting); waiting = setTimeout(changed, 40); });
    form.addEventListener("submit", (event) => event.preventDefault());
    form.addEventListener("reset", () => setTimeout(() => { changed(); form.elements.q.focus(); }));
    more.addEventListener("click", extend);
    new IntersectionObserver((entries) => { if (entries.some((entry) => entry.isIntersecting)) extend(); }, { rootMargin: "600px" }).observe(more);
    apply();
  }
  document.addEventListener("keydown", (event) => {
    const typing = /^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement.tagName);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "/" && !typing && form) {
      event.preventDefault();
      if (open) { location.hash = listHash; follow(); }
      form.elements.q.focus();
    } else if (event.key === "Escape" && open) location.hash = listHash;
    else if (event.key === "Escape" && typing && document.activeElement.form === form) form.reset();
    else if (open && !typing && event.key === "ArrowLeft") page.querySelector("a[rel=prev]")?.click();
    else if (open && !typing && event.key === "ArrowRight") page.querySelector("a[rel=next]")?.click();
  });
  // What is folded about the models is printed too, and folded again.
  let unfolded = [];
  addEventListener("beforeprint", () => { unfolded = all("#models details:not([open])"); for (const fold of unfolded) fold.open = true; });
  addEventListener("afterprint", () => { for (const fold of unfolded) fold.open = false; });
  addEventListener("hashchange", follow);
  follow();
})();
