nonioDrawn({tip: document.body.appendChild(Object.assign(document.createElement("div"), {id: "tip", hidden: true})), words: nonioWords}).adopt(document);
