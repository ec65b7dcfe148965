// The files of a reading, in memory, for the C library: in place of emscripten's file system, which is a page's
// weight in JavaScript. `Module.givenFiles.all` maps names to bytes. Nothing is written.
mergeInto(LibraryManager.library, {
  $givenFiles__postset: "Module['givenFiles'] = givenFiles;",
  $givenFiles: { all: new Map(), open: [], first: 3 }, // descriptors count from there
  __syscall_open__deps: ["$givenFiles"],
  __syscall_open: function(path, flags, varargs) {
    var bytes = givenFiles.all.get(UTF8ToString(path));
    if (!bytes) return -{{{ cDefine('ENOENT') }}};
    return givenFiles.open.push({ bytes: bytes, at: 0 }) - 1 + givenFiles.first;
  },
  __syscall_stat64__deps: ["$givenFiles"],
  __syscall_stat64: function(path, buf) {
    var bytes = givenFiles.all.get(UTF8ToString(path));
    if (!bytes) return -{{{ cDefine('ENOENT') }}};
    HEAPU8.fill(0, buf, buf + {{{ C_STRUCTS.stat.__size__ }}});
    {{{ makeSetValue('buf', C_STRUCTS.stat.st_mode, cDefine('S_IFREG'), 'i32') }}};
    {{{ makeSetValue('buf', C_STRUCTS.stat.st_size, 'bytes.length', 'i64') }}};
    return 0;
  },
  fd_close__deps: ["$givenFiles"],
  fd_close: function(fd) {
    givenFiles.open[fd - givenFiles.first] = null;
    while (givenFiles.open.length > 0 && !givenFiles.open[givenFiles.open.length - 1]) givenFiles.open.pop();
    return 0;
  },
  fd_read__deps: ["$givenFiles"],
  fd_read: function(fd, iov, iovcnt, pnum) {
    var file = givenFiles.open[fd - givenFiles.first];
    var num = 0;
    for (var i = 0; i < iovcnt; i++, iov += {{{ C_STRUCTS.iovec.__size__ }}}) {
      var to = {{{ makeGetValue('iov', C_STRUCTS.iovec.iov_base, 'i32') }}};
      var part = file.bytes.subarray(file.at, file.at + {{{ makeGetValue('iov', C_STRUCTS.iovec.iov_len, 'i32') }}});
      HEAPU8.set(part, to);
      file.at += part.length;
      num += part.length;
    }
    {{{ makeSetValue('pnum', 0, 'num', 'i32') }}};
    return 0;
  },
  fd_seek__deps: ["$givenFiles"],
  fd_seek: function(fd, {{{ defineI64Param('offset') }}}, whence, newOffset) {
    {{{ receiveI64ParamAsI32s('offset') }}}
    var file = givenFiles.open[fd - givenFiles.first];
    var from = [0, file.at, file.bytes.length][whence];
    var at = from + offset_high * 0x100000000 + (offset_low >>> 0);
    if (at < 0) return {{{ cDefine('EINVAL') }}};
    file.at = at;
    {{{ makeSetValue('newOffset', '0', 'file.at', 'i64') }}};
    return 0;
  },
});
