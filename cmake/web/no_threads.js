// What emscripten's C library without threads lacks.
mergeInto(LibraryManager.library, {
  pthread_getcpuclockid: function() { return 52; }, // ENOSYS
});
