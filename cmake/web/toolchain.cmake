# Compiles for WebAssembly with Debian's emscripten (docs/web.md). Eigen's SSE2 code is compiled for WebAssembly's
# SIMD, so that it adds in the order of a native build: same input, same bits.
set(CMAKE_CXX_LINKER_LAUNCHER env NODE_PATH=/usr/share/nodejs)  # for acorn
set(web ${CMAKE_CURRENT_LIST_DIR})
string(JOIN " " CMAKE_CXX_FLAGS_INIT
  -fwasm-exceptions -msimd128 -msse2
  # Eigen chooses assembler of x86 for compilers that call themselves gcc before 6.3, or after 6.0 in minor versions.
  -fgnuc-version=5.13.0
  -isystem ${web}/include -include ${web}/newer_library.hpp)
set(CMAKE_EXE_LINKER_FLAGS_INIT "--js-library ${web}/no_threads.js")
set(Eigen3_DIR /usr/share/eigen3/cmake)
set(CMAKE_HAVE_LIBC_PTHREAD ON)  # stubs: no threads
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
