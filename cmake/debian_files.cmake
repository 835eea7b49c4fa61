# CPack runs this script for each package before it is packed. It adds the files that Debian's policy requires (copyright,
# changelog, compressed manual pages) in place of LICENSE and CHANGELOG.md.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} name)
  set(package ${CPACK_DEBIAN_${name}_PACKAGE_NAME})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  if(NOT IS_DIRECTORY ${root})
    continue()
  endif()
  set(documents ${root}/share/doc/${package})
  file(MAKE_DIRECTORY ${documents})
  file(REMOVE ${documents}/LICENSE ${documents}/CHANGELOG.md)

  file(READ ${CPACK_E2LF_SOURCE_DIR}/LICENSE license)
  string(REGEX REPLACE "^MIT License\n\n" "" license "${license}")
  string(REGEX MATCH "Copyright[^\n]*" copyright "${license}")
  string(REGEX REPLACE "^Copyright[^\n]*\n\n" "" license "${license}")
  string(STRIP "${license}" license)
  string(REPLACE "\n\n" "\n.\n" license "${license}")
  string(REPLACE "\n" "\n " license "${license}")
  string(REPLACE "Copyright (c) " "" copyright "${copyright}")
  file(WRITE ${documents}/copyright
    "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: e2lf\n\n"
    "Files: *\nCopyright: ${copyright}\nLicense: Expat\n ${license}\n")

  string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${documents}/changelog
    "e2lf (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n  * See README.md.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${today}\n")
  file(GLOB compressed ${documents}/changelog ${root}/share/man/man1/*.1)
  execute_process(COMMAND gzip -9nf ${compressed} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
