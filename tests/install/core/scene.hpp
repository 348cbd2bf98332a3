#error "the library's headers must not find the headers of its users"
