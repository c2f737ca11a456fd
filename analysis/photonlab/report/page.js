// What a report's page does: sorts its tables, and with viewer.js behind it compares its images.

"use strict";

const element = (id) => document.getElementById(id);

// Tables: a click on a column's name sorts by it, another one turns the order. What is missing stays last.

function sortBy(heading) {
    const table = heading.closest("table");
    const column = heading.cellIndex;
    const direction = heading.ariaSort === "ascending" ? -1 : 1;
    const compare = (left, right) => {
        const [a, b] = [left.cells[column], right.cells[column]];
        if (!heading.classList.contains("number"))
            return direction * a.textContent.localeCompare(b.textContent, "en", {numeric: true});
        if (!a.dataset.value || !b.dataset.value) return !a.dataset.value - !b.dataset.value;
        return direction * (Number(a.dataset.value) - Number(b.dataset.value));
    };
    for (const other of heading.parentNode.cells) other.removeAttribute("aria-sort");
    heading.ariaSort = direction > 0 ? "ascending" : "descending";
    table.tBodies[0].append(...[...table.tBodies[0].rows].sort(compare));
}

for (const button of document.querySelectorAll(".sortable th button"))
    button.addEventListener("click", () => sortBy(button.closest("th")));
