# Installs Palpate's package, moves it, and builds and runs the projects of tests/consumer with it; or
# builds one of them with the sources taken in. Each STEP is a test.
cmake_minimum_required(VERSION 3.25)
string(REPLACE "," ";" parts "${COMPONENTS}")
set(tree ${WORK_DIR}/prefix)
set(build ${WORK_DIR}/build)
set(consumers ${SOURCE_DIR}/tests/consumer)

function(run)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=PALPATE_IO_HELPER ${ARGV}
                  RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "status ${status} from: ${command}")
  endif()
endfunction()

# Runs a command that must fail, with a message that matches `expected`.
function(refused expected)
  execute_process(COMMAND ${CMAKE_COMMAND} -E env --unset=PALPATE_IO_HELPER ${ARGN}
                  RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  if(status EQUAL 0 OR NOT said MATCHES "${expected}")
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "status ${status} from: ${command}\nexpected: ${expected}\nfound: ${said}")
  endif()
endfunction()

set(configure ${CMAKE_COMMAND} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=None -DEigen3_DIR=${EIGEN_DIR})

# An installed package is moved and copied: no file of it may know where it was built. Programs and
# libraries with line tables do.
function(check_paths)
  file(GLOB_RECURSE files ${tree}/*.cmake ${tree}/*.in ${tree}/*.hpp)
  if(CONFIG MATCHES "^(Release|MinSizeRel)$")
    file(GLOB_RECURSE files ${tree}/*)
  endif()
  foreach(file IN LISTS files)
    foreach(path ${SOURCE_DIR} ${BINARY_DIR} ${WORK_DIR})
      file(STRINGS ${file} found REGEX "${path}/" LIMIT_COUNT 1)
      if(found)
        message(FATAL_ERROR "${file} names ${path}, which only this machine has: ${found}")
      endif()
    endforeach()
  endforeach()
endfunction()

# The readers' program is found in the moved package, and nowhere else.
function(check_helper)
  set(helper ${tree}/libexec/palpate/palpate-io-helper)
  if(NOT EXISTS ${helper} OR EXISTS ${INSTALL_PREFIX}/libexec/palpate/palpate-io-helper)
    return()
  endif()
  file(RENAME ${helper} ${helper}-hidden)
  refused("palpate-io-helper was not found in .*prefix/libexec/palpate.*PALPATE_IO_HELPER"
          ${build}/session/session)
  file(RENAME ${helper}-hidden ${helper})
endfunction()

if(STEP STREQUAL install)
  file(REMOVE_RECURSE ${WORK_DIR})  # nothing from an earlier run may help this one
  set(first ${WORK_DIR}/first-prefix)
  if("io" IN_LIST parts)
    list(APPEND parts io-helper program)
  endif()
  foreach(part IN LISTS parts)
    run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${first} --config ${CONFIG}
        --component palpate-${part})
  endforeach()
  file(RENAME ${first} ${tree})
  check_paths()
  set(words -DCOMPONENTS=${COMPONENTS} -DCMAKE_PREFIX_PATH=${tree} -DREADME=${SOURCE_DIR}/README.md)
  run(${configure} -S ${consumers} -B ${build} ${words})
elseif(STEP STREQUAL consumer)
  run(${CMAKE_COMMAND} --build ${build} --parallel 2 --target consumer)
  run(${build}/core/consumer)
  if("devices" IN_LIST parts)
    run(${CMAKE_COMMAND} --build ${build} --parallel 2 --target session)
    run(${build}/session/session)
    check_helper()
    run(${tree}/bin/palpate info ${build}/session/ball.nrrd)
  endif()
  if("run" IN_LIST parts)
    run(${CMAKE_COMMAND} --build ${build} --parallel 2 --target live_run)
    run(${build}/run/live_run)
  endif()
elseif(STEP STREQUAL headers)
  run(${CMAKE_COMMAND} --build ${build} --parallel 2 --target headers)
elseif(STEP STREQUAL readme)
  run(${CMAKE_COMMAND} --build ${build} --parallel 2 --target readme)
elseif(STEP STREQUAL missing)
  # A package of the core alone.
  set(core ${WORK_DIR}/core-alone)
  run(${CMAKE_COMMAND} --install ${BINARY_DIR} --prefix ${core} --config ${CONFIG}
      --component palpate-core)
  set(ask ${configure} -S ${consumers}/missing --fresh -DCMAKE_PREFIX_PATH=${core} -DVERSION=${VERSION})
  refused("component 'io' is not installed in .*core-alone \\(Palpate builds it with -DPALPATE_IO=ON\\)"
          ${ask} -B ${WORK_DIR}/missing -DCOMPONENT=io)
  refused("there is no component 'readers' \\(the components are core, "
          ${ask} -B ${WORK_DIR}/missing -DCOMPONENT=readers)
  run(${ask} -B ${WORK_DIR}/missing -DCOMPONENT=io -DOPTIONAL=ON)
elseif(STEP STREQUAL versions)
  # What docs/package.md promises: the same minor version, and no patch that is newer.
  string(REPLACE "." ";" numbers "${VERSION}")
  list(GET numbers 0 major)
  list(GET numbers 1 minor)
  list(GET numbers 2 patch)
  math(EXPR before "${minor} - 1")
  math(EXPR after "${minor} + 1")
  math(EXPR newer "${patch} + 1")
  set(ask ${configure} -S ${consumers}/missing -B ${WORK_DIR}/versions --fresh
          -DCMAKE_PREFIX_PATH=${tree} -DCOMPONENT=core)
  foreach(other ${major}.${before} ${major}.${after} 1.0 ${major}.${minor}.${newer})
    refused("compatible with requested version.*\"${other}\"" ${ask} -DVERSION=${other})
  endforeach()
  run(${ask} -DVERSION=${major}.${minor})
  run(${ask} -DVERSION=${VERSION})
elseif(STEP STREQUAL embedded)
  set(build ${WORK_DIR}-embedded)
  file(REMOVE_RECURSE ${build})
  # Several sources at a time: that takes half as long.
  run(${configure} -S ${consumers} -B ${build} -DPALPATE_SOURCE_DIR=${SOURCE_DIR}
      -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=32)
  run(${CMAKE_COMMAND} --build ${build} --parallel 2 --target consumer)
  run(${build}/core/consumer)
else()
  message(FATAL_ERROR "no step '${STEP}'")
endif()
