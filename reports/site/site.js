nonioLines(document);
