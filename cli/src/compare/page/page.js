"use strict";
const stage = document.getElementById("stage");
const slider = document.getElementById("slider");
const legend = document.getElementById("legend");
const marks = document.getElementById("marks");
const views = document.querySelector(".views");
const legends = {
  slide: "A on the left, B on the right: drag, or use the arrow keys.",
  a: "A. The arrow keys flip between the pictures.",
  b: "B. The arrow keys flip between the pictures.",
  difference: "The absolute difference, brightened so that the largest is white.",
  flip: "FLIP: black is equal, pale yellow is as different as can be.",
};
function show() {
  // A page that is gone back to keeps what was chosen; so what is chosen is read, not remembered.
  const view = new FormData(views).get("view");
  stage.dataset.view = view;
  legend.textContent = legends[view];
  stage.style.setProperty("--at", slider.value + "%");
  stage.classList.toggle("marked", marks !== null && marks.checked);
}
views.addEventListener("input", show);
views.addEventListener("submit", (event) => event.preventDefault());
slider.addEventListener("input", show);
show();
