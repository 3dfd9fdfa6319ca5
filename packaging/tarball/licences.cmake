# Runs while the files of the tarball are installed: the licences of what is linked into its programs, in
# share/doc/abbe/licences. That of Boost asks for none beside programs.
set(root "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")

function(install_licence package)
  if(NOT EXISTS /usr/share/doc/${package}/copyright)
    message(FATAL_ERROR "the licence of ${package} was not found: /usr/share/doc/${package}/copyright")
  endif()
  configure_file(/usr/share/doc/${package}/copyright ${root}/share/doc/abbe/licences/${package}.txt COPYONLY)
endfunction()

foreach(package IN ITEMS libc6-dev libstdc++-12-dev libfmt-dev libhwy-dev libeigen3-dev libcli11-dev libtomlplusplus-dev
        nlohmann-json3-dev zlib1g-dev libexpat1-dev libsqlite3-dev)
  install_licence(${package})
endforeach()
# The pages of the reports, which are part of the programs, contain three.js.
configure_file(${CMAKE_CURRENT_LIST_DIR}/../debian/abbe.copyright ${root}/share/doc/abbe/licences/three.js.txt COPYONLY)
