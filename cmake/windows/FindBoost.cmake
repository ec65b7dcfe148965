# Headers alone.
include(${CMAKE_CURRENT_LIST_DIR}/headers.cmake)
palpate_headers(Boost::headers boost)
set(Boost_FOUND TRUE)
