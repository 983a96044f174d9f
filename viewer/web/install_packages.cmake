# Installs the packages of package-lock.json: cmake -DNPM=<npm> -P install_packages.cmake
execute_process(COMMAND ${NPM} ci --no-audit --no-fund --ignore-scripts --loglevel=error RESULT_VARIABLE status)
if(status)
  message(FATAL_ERROR "npm cannot install the packages of viewer/web; -DTROUPE_WEB_PAGE=OFF builds without the page")
endif()
file(TOUCH node_modules/.package-lock.json)
