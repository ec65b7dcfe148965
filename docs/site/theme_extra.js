// Debian's MkDocs lacks this file of its theme: tables get the theme's style, and the navigation shows
// the page that is open. The page for the browser opens in place of its link.
document.addEventListener("DOMContentLoaded", function () {
  document.querySelectorAll("table").forEach(function (table) { table.classList.add("docutils"); });
  const open = document.querySelector(".wy-menu-vertical a.current");
  const side = document.querySelector(".wy-side-scroll");
  if (open && side && open.offsetTop > side.clientHeight) side.scrollTop = open.offsetTop - 100;
  const link = document.querySelector("a.touch-here");
  if (link) link.addEventListener("click", function (event) {
    if (location.protocol === "file:") return; // modules need a server
    event.preventDefault();
    const frame = document.createElement("iframe");
    frame.src = link.href;
    frame.title = "Touch a CT head";
    frame.className = "touch-here";
    link.replaceWith(frame);
    frame.focus();
  });
});
