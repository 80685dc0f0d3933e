Names read_names(const YamlNode& node, const std::string& key);
Names moving = read_names(node, "moving");
