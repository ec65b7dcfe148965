# Builds and runs tests/consumer with Palpate, either as an installed package (MODE installed: the
# build is first installed under a prefix of its own) or as sources taken in (MODE embedded).
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "status ${status} from: ${command}")
  endif()
endfunction()

# Nothing from an earlier run may help this one.
file(REMOVE_RECURSE ${WORK_DIR})

set(where -DPALPATE_SOURCE_DIR=${SOURCE_DIR})
if(MODE STREQUAL installed)
  set(prefix ${WORK_DIR}/prefix)
  run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${prefix} --config ${CONFIG})
  set(where -DCMAKE_PREFIX_PATH=${prefix})
  # An installed package is moved and copied: it may not know where it was built.
  file(GLOB_RECURSE package ${prefix}/*.cmake ${prefix}/*.hpp)
  foreach(file ${package})
    file(READ ${file} text)
    foreach(path ${SOURCE_DIR} ${BINARY_DIR} ${prefix})
      string(FIND "${text}" "${path}/" found)
      if(NOT found EQUAL -1)
        message(FATAL_ERROR "${file} names ${path}, which only this machine has")
      endif()
    endforeach()
  endforeach()
  if(EXISTS ${prefix}/bin/palpate)
    run(${prefix}/bin/palpate --help)
  endif()
endif()

run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/tests/consumer -B ${WORK_DIR}/build -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
    -DCMAKE_BUILD_TYPE=Release -DEigen3_DIR=${EIGEN_DIR} ${where})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build --parallel 2 --target consumer)
run(${WORK_DIR}/build/consumer)
