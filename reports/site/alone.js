const nonioWords = JSON.parse(document.getElementById("words").textContent);
