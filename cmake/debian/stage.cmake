# CPack runs this when the files of all packages are staged, before it makes the packages: adds what
# Debian's policy asks of every package, and what only packages install.
set(here ${CMAKE_CURRENT_LIST_DIR})

function(compress file)
  execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Not file(INSTALL), which heeds CPack's DESTDIR.
function(put file target)
  configure_file(${file} ${target} COPYONLY)
endfunction()

# Folder of a group -> package.
set(package_program palpate)
set(package_helper palpate-io-helper)
set(package_shared libpalpate-c0)
set(package_development libpalpate-dev)
set(package_python python3-palpate)

file(GLOB groups LIST_DIRECTORIES true ${CPACK_TEMPORARY_DIRECTORY}/*)
foreach(stage ${groups})
  get_filename_component(group ${stage} NAME)
  if(NOT IS_DIRECTORY ${stage} OR NOT DEFINED package_${group})
    continue()
  endif()
  # The licence is in `copyright`.
  file(REMOVE_RECURSE ${stage}/usr/share/doc/palpate)
  set(doc ${stage}/usr/share/doc/${package_${group}})
  put(${here}/copyright ${doc}/copyright)
  file(READ ${here}/changelog.in changelog)
  string(CONFIGURE "${changelog}" changelog @ONLY)
  file(WRITE ${doc}/changelog.Debian "${changelog}")
  compress(${doc}/changelog.Debian)
  file(GLOB pages ${stage}/usr/share/man/man*/*.[0-9])
  foreach(page ${pages})
    compress(${page})
  endforeach()
  # CPack strips programs and shared libraries alone.
  file(GLOB_RECURSE archives ${stage}/*.a)
  foreach(archive ${archives})
    execute_process(COMMAND strip --strip-debug --enable-deterministic-archives ${archive}
                    COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endforeach()

set(stage ${CPACK_TEMPORARY_DIRECTORY}/program)
put(${here}/70-palpate.rules ${stage}/usr/lib/udev/rules.d/70-palpate.rules)
file(CREATE_LINK palpate-view.1.gz ${stage}/usr/share/man/man1/palpate-viewer.1.gz SYMBOLIC)
put(${here}/palpate.conf ${stage}/etc/security/limits.d/palpate.conf)

# Whatever umask the build had.
foreach(stage ${groups})
  if(IS_DIRECTORY ${stage})
    execute_process(COMMAND chmod -R u=rwX,go=rX ${stage} COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
