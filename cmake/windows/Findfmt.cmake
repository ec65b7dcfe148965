# Headers alone.
include(${CMAKE_CURRENT_LIST_DIR}/headers.cmake)
palpate_headers(fmt::fmt fmt)
set_property(TARGET fmt::fmt PROPERTY INTERFACE_COMPILE_DEFINITIONS FMT_HEADER_ONLY)
set(fmt_FOUND TRUE)
