"use strict";
// Addresses within the page: links to figures and claims that a button copies, and the filters of the claims, which are a part of the address.
(() => {
  // Links to figures and claims. The address of the window has the link also where a page may not use the clipboard.
  const addCopy = (within, id, name) => {
    const made = addButton(within, "Copy link", () => {
      window.history.replaceState(null, "", `#${id}`);
      const copied = navigator.clipboard ? navigator.clipboard.writeText(window.location.href) : Promise.reject();
      copied.then(() => "Copied", () => "See the address").then((text) => { made.textContent = text; });
      setTimeout(() => { made.textContent = "Copy link"; }, 2000);
    });
    made.className = "copy";
    made.title = `Copy the link to ${name}`;
  };
  all("figure[id] > figcaption").forEach((caption) => addCopy(caption, caption.parentElement.id, "this figure"));
  all("tr[id^='claim-']").forEach((row) => addCopy(row.cells[0], row.id, row.id.replace("-", " ")));
  // Addresses have codes for letters beyond ASCII; a text that is no code stays as it is.
  const decoded = (text) => {
    try {
      return decodeURIComponent(text);
    } catch {
      return text;
    }
  };
  // An address names a part of the page, and the filters of the claims: `#claims&report=Report+A&verdict=open`.
  const address = () => {
    const [id, ...filters] = window.location.hash.slice(1).split("&");
    return [decoded(id), new URLSearchParams(filters.join("&"))];
  };
  const visit = () => {
    const [id] = address();
    const target = id ? document.getElementById(id) : null;
    if (!target) return;
    for (let part = target.closest("details"); part; part = part.parentElement.closest("details")) part.open = true;
    target.scrollIntoView();
  };
  window.addEventListener("hashchange", visit);

  // The claims, by report and by verdict. A filter opens the tables that it leaves rows in.
  const claims = document.getElementById("claims");
  const tables = claims ? all("details", claims).filter((table) => table.querySelector("td[data-verdict]")) : [];
  if (tables.length > 0) {
    const nameOf = (table) => table.querySelector("summary").textContent.split(":")[0];
    const verdictOf = (row) => row.querySelector("td[data-verdict]").dataset.verdict;
    const rowsOf = (table) => Array.from(table.querySelector("tbody").rows);
    const chooser = (name, choices) => {
      const label = document.createElement("label");
      const choice = document.createElement("select");
      ["all", ...new Set(choices)].forEach((of) => choice.append(new Option(of, of)));
      choice.addEventListener("change", () => {
        filter();
        window.history.replaceState(null, "", `#claims${[reports, verdicts].map(({ filtered }) => filtered()).join("")}`);
      });
      label.append(`${name}: `, choice);
      const key = name.toLowerCase();
      const isAll = () => choice.value === "all";
      return {
        label,
        isAll,
        has: (of) => isAll() || choice.value === of,
        filtered: () => (isAll() ? "" : `&${new URLSearchParams([[key, choice.value]])}`),
        restore: (filters) => {
          const wanted = filters.get(key);
          choice.value = Array.from(choice.options).some((option) => option.value === wanted) ? wanted : "all";
        },
      };
    };
    const reports = chooser("Report", tables.map(nameOf));
    const verdicts = chooser("Verdict", tables.flatMap(rowsOf).map(verdictOf).sort());
    const shown = document.createElement("output");
    const filter = () => {
      tables.forEach((table) => {
        const rows = rowsOf(table);
        rows.forEach((row) => { row.hidden = !verdicts.has(verdictOf(row)); });
        const left = rows.filter((row) => !row.hidden).length;
        table.hidden = !reports.has(nameOf(table)) || left === 0;
        table.previousElementSibling.hidden = table.hidden;
        if (!reports.isAll() || !verdicts.isAll()) table.open = true;
      });
      const rows = tables.flatMap(rowsOf);
      shown.textContent = `${rows.filter((row) => !row.hidden && !row.closest("details").hidden).length} of ${rows.length} claims`;
    };
    const filters = document.createElement("p");
    filters.className = "filters";
    filters.append(reports.label, verdicts.label, shown);
    claims.querySelector("h2").after(filters);
    const restore = () => {
      const [id, wanted] = address();
      // Other addresses leave the filters alone, as one of a claim does that is shown.
      if (id === "claims") [reports, verdicts].forEach((choice) => choice.restore(wanted));
      filter();
    };
    window.addEventListener("hashchange", restore);
    restore();
  }
  visit();
})();
