// Debian's MkDocs lacks this file of its theme: tables get the theme's style, and the navigation shows
// the page that is open.
document.addEventListener("DOMContentLoaded", function () {
  document.querySelectorAll("table").forEach(function (table) { table.classList.add("docutils"); });
  const open = document.querySelector(".wy-menu-vertical a.current");
  const side = document.querySelector(".wy-side-scroll");
  if (open && side && open.offsetTop > side.clientHeight) side.scrollTop = open.offsetTop - 100;
});
